// Comma-separated values (RFC 4180).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "cells.hpp"

namespace vdwmesh::apps {

// Text with a comma, quote or line break is quoted.
std::string csv_field(std::string_view text);
// The fewest digits that read back the same; nothing where it is not finite.
std::string csv_number(double value);

// A header and one line per row. `columns` is the header: names of cells with commas between.
std::string csv_table(std::string_view columns, const std::vector<Cells>& rows);

}  // namespace vdwmesh::apps
