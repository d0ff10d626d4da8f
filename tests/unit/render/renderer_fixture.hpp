// For tests that draw: they skip with the reason where nothing can be drawn, and fail there with
// VDWMESH_REQUIRE_EGL=1.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "core/errors.hpp"
#include "render/renderer.hpp"
#include "support/requirements.hpp"

namespace vdwmesh::testing {

class DrawingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    try {
      renderer_ = std::make_unique<Renderer>();
    } catch (const BackendUnavailable& error) {
      VDWMESH_MISSING("VDWMESH_REQUIRE_EGL", error.what());
    }
  }
  Picture draw(const IndexedMesh& mesh, Paint paint, const RenderOptions& options) const {
    return renderer_->draw(MeshSource(mesh, std::move(paint)), options);
  }

 private:
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace vdwmesh::testing
