#include "structure/reader.hpp"
