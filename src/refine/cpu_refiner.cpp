#include "refine/refiner.hpp"
