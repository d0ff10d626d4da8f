// VertexLabels: one sphere a vertex, or up to three.
#include "surface/vertex_labels.hpp"

#include <gtest/gtest.h>

namespace vdwmesh {
namespace {

constexpr VertexSpheres kCrease{2, 5, kNoSphere}, kCorner{1, 2, 5};

TEST(VertexLabels, AtomsAloneTakeOneArray) {
  VertexLabels labels;
  EXPECT_TRUE(labels.empty());
  EXPECT_EQ(labels.width(), LabelWidth::none);
  labels.push_back(on_sphere(4));
  labels.push_back(on_sphere(kNoSphere));
  EXPECT_EQ(labels.size(), 2u);
  EXPECT_EQ(labels.width(), LabelWidth::one);
  EXPECT_TRUE(labels.others.empty());
  EXPECT_EQ(labels[0], on_sphere(4));
  EXPECT_EQ(labels[1], on_sphere(kNoSphere));
  labels.set(1, on_sphere(3));
  EXPECT_EQ(labels[1], on_sphere(3));
}

TEST(VertexLabels, ALabelOfSeveralSpheresMakesRoomForAll) {
  VertexLabels labels;
  labels.push_back(on_sphere(4));
  labels.push_back(kCorner);
  labels.push_back(on_sphere(6));
  EXPECT_EQ(labels.width(), LabelWidth::three);
  EXPECT_EQ(labels[0], on_sphere(4));
  EXPECT_EQ(labels[1], kCorner);
  EXPECT_EQ(labels[2], on_sphere(6));
  labels.set(0, kCrease);
  labels.set(1, on_sphere(1));
  EXPECT_EQ(labels[0], kCrease);
  EXPECT_EQ(labels[1], on_sphere(1));
}

TEST(VertexLabels, AssignedOnesHaveTheRoomTheyNeed) {
  VertexLabels labels;
  labels.assign(3, kCrease);
  EXPECT_EQ(labels.width(), LabelWidth::three);
  for (std::size_t v = 0; v < 3; ++v) EXPECT_EQ(labels[v], kCrease);
  labels.assign(2, on_sphere(0));
  EXPECT_EQ(labels.width(), LabelWidth::one);
  EXPECT_EQ(labels.size(), 2u);
}

TEST(VertexLabels, KeepWhatTheyHadWhenTheyGrow) {
  VertexLabels labels;
  labels.push_back(kCrease);
  labels.resize(2, LabelWidth::three);
  labels.set(1, kCorner);
  EXPECT_EQ(labels[0], kCrease);
  EXPECT_EQ(labels[1], kCorner);
  EXPECT_EQ(labels.others.size(), 2u);
}

TEST(VertexLabels, AreEqualWhateverTheirRoom) {
  VertexLabels narrow, wide;
  narrow.assign(2, on_sphere(1));
  wide.assign(2, on_sphere(1));
  wide.widen();
  EXPECT_EQ(wide.width(), LabelWidth::three);
  EXPECT_EQ(narrow, wide);
  EXPECT_EQ(wide, narrow);
  wide.set(1, {1, 2, kNoSphere});
  EXPECT_NE(narrow, wide);
  EXPECT_NE(wide, narrow);
  narrow.assign(3, on_sphere(1));
  EXPECT_NE(narrow, wide);
}

TEST(VertexLabels, GiveBackTheRoomThatNoneOfThemNeeds) {
  VertexLabels labels;
  labels.assign(2, on_sphere(1));
  labels.widen();
  labels.narrow();
  EXPECT_EQ(labels.width(), LabelWidth::one);
  EXPECT_EQ(labels.others.capacity(), 0u);
  EXPECT_EQ(labels[1], on_sphere(1));
  labels.push_back(kCrease);
  labels.narrow();
  EXPECT_EQ(labels.width(), LabelWidth::three);
  EXPECT_EQ(labels[2], kCrease);
}

TEST(VertexLabels, BytesAreThoseOfTheirIds) {
  EXPECT_EQ(label_bytes(LabelWidth::none), 0u);
  EXPECT_EQ(label_bytes(LabelWidth::one), 4u);
  EXPECT_EQ(label_bytes(LabelWidth::three), 12u);
}

}  // namespace
}  // namespace vdwmesh
