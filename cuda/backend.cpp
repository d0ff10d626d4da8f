#include "cuda/backend.hpp"
