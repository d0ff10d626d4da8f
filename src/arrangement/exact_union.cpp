#include "arrangement/exact_union.hpp"
