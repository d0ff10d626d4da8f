// The document that docs/study.schema.json describes.
#pragma once

#include "json_writer.hpp"
#include "study/study.hpp"

namespace vdwmesh::apps {

Json study_document(const Study& study);

}  // namespace vdwmesh::apps
