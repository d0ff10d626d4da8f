#include "analysis/mesh_measures.hpp"
