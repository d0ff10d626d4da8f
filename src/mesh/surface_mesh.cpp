#include "mesh/surface_mesh.hpp"
