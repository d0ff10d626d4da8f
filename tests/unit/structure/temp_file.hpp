// Small input files, written for one test and removed after it.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>
#include <zlib.h>

#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>

#include "core/errors.hpp"
#include "structure/reader.hpp"
#include "support/temporary_directory.hpp"

namespace vdwmesh::testing {

inline std::string gzipped(const std::string& content) {
  z_stream stream{};
  deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  std::string packed(deflateBound(&stream, content.size()) + 64, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  deflate(&stream, Z_FINISH);
  packed.resize(packed.size() - stream.avail_out);
  deflateEnd(&stream);
  return packed;
}

// atoms_read = atoms_used + everything skipped.
inline void expect_account_adds_up(const Molecule& molecule) {
  const std::uint64_t skipped =
      std::accumulate(molecule.skipped.begin(), molecule.skipped.end(), std::uint64_t{0},
                      [](std::uint64_t sum, const auto& reason) { return sum + reason.second; });
  EXPECT_EQ(molecule.atoms_read, molecule.atoms_used + skipped) << molecule.path;
}

// Reads `content` from a file of that name.
inline Molecule read_text_as(const std::string& name, const std::string& content,
                             const ReadOptions& options = {}) {
  const TemporaryDirectory dir;
  Molecule molecule = read_structure(dir.write(name, content), options);
  expect_account_adds_up(molecule);
  return molecule;
}

// The message of the error of type E that reading must end in; one line.
template <class E>
std::string refusal_of(const std::filesystem::path& path, const ReadOptions& options = {}) {
  try {
    read_structure(path, options);
  } catch (const E& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
  }
  ADD_FAILURE() << path << " was read";
  return {};
}

template <class E>
std::string refusal_of_text(const std::string& name, const std::string& content,
                            const ReadOptions& options = {}) {
  const TemporaryDirectory dir;
  return refusal_of<E>(dir.write(name, content), options);
}

}  // namespace vdwmesh::testing
