#include "extract/sphere_set.hpp"
