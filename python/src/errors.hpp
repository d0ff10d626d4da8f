// Exceptions of the library as exceptions of Python.
#pragma once

#include <pybind11/pybind11.h>

#include <string_view>

namespace vdwmesh::python {

// From now on an exception of core/errors.hpp becomes the class of the same name in vdwmesh.errors,
// with its one line as the message. std::bad_alloc and errors of std::filesystem become
// LimitExceeded and FileFormatError; every other exception is our own fault, an InternalError.
void translate_errors();

// A name from a file as Python's str. Bytes that are no UTF-8 become surrogates, as in names that
// os.listdir() gives, so they come back as they were.
pybind11::object text_of(std::string_view bytes);

// A message, note or warning of the library in Python's terms (vdwmesh.errors). It can be printed
// whatever the file holds: bytes that are no UTF-8 are written out, as in "l\xe4t.pdb".
pybind11::object message_of(std::string_view message);

// A tuple of messages.
template <class Messages>
pybind11::tuple messages_of(const Messages& messages) {
  pybind11::list list;
  for (const auto& message : messages) list.append(message_of(message));
  return pybind11::tuple(std::move(list));
}

}  // namespace vdwmesh::python
