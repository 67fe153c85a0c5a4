// The meshes of a glTF scene as it places them: instances, mirror images, colors, morph targets and skins.
#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/mesh_files/gltf_file.h"
#include "tests/unit/client/mesh_files/gltf_document.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// Returns the document whose node has instances, with accessor 2 on `bytes` as the attribute.
SortedJson Instanced(const char* attribute, SortedJson accessor, const std::string& bytes) {
  SortedJson document = Document(bytes);
  accessor["bufferView"] = 2;
  document["accessors"].push_back(accessor);
  document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"][attribute] = 2;
  return document;
}

TEST(GltfFile, InstancesArePlacedWithinTheirNode) {
  const std::string places = BytesOf<float>({0, 0, 0, 2, 0, 0, 8, 0, 0});
  const SortedJson document =
      Instanced("TRANSLATION", {{"componentType", 5126}, {"count", 3}, {"type", "VEC3"}}, places);
  const Mesh mesh = Parse(With(document, "/nodes/0/scale", {10, 1, 1})).value();
  EXPECT_EQ(mesh.triangles.size(), 6);
  EXPECT_THAT(mesh.positions[1], ElementsAre(10, 0, 0));
  EXPECT_THAT(mesh.positions[5], ElementsAre(30, 0, 0));
  EXPECT_THAT(mesh.positions[9], ElementsAre(90, 0, 0));
  EXPECT_THAT(mesh.stretches, testing::SizeIs(3));
  EXPECT_TRUE(ParseGltf(document.dump(), "", {}, 12).ok());
  EXPECT_EQ(ParseGltf(document.dump(), "", {}, 11).status().code(), absl::StatusCode::kResourceExhausted);

  // A quarter turn about z as normalized bytes; the node's children have no instances of their own.
  SortedJson turned =
      Instanced("ROTATION", {{"componentType", 5120}, {"normalized", true}, {"count", 1}, {"type", "VEC4"}},
                BytesOf<int8_t>({0, 0, 90, 90}));
  turned["nodes"].push_back({{"mesh", 0}});
  turned["nodes"][0]["children"] = {1};
  const Mesh two = Parse(turned).value();
  EXPECT_THAT(two.positions[1], ElementsAre(0, 1, 0));
  EXPECT_THAT(two.positions[5], ElementsAre(1, 0, 0));
}

TEST(GltfFile, AttributesOfInstancesAgree) {
  const std::string places = BytesOf<float>({0, 0, 0, 2, 0, 0, 0, 0});
  SortedJson document = Instanced("TRANSLATION", {{"componentType", 5126}, {"count", 2}, {"type", "VEC3"}}, places);
  document["accessors"].push_back(
      {{"bufferView", 2}, {"byteOffset", 16}, {"componentType", 5126}, {"count", 1}, {"type", "VEC3"}});
  const char* const attributes = "/nodes/0/extensions/EXT_mesh_gpu_instancing/attributes";
  EXPECT_THAT(Refusal(With(document, attributes, {{"TRANSLATION", 2}, {"SCALE", 3}})),
              HasSubstr("nodes[0]: EXT_mesh_gpu_instancing: its attributes have 2 and 1 elements"));
  EXPECT_THAT(Refusal(With(document, attributes, {{"ROTATION", 3}})), HasSubstr("ROTATION has 3 components, not 4"));
  EXPECT_THAT(Refusal(With(With(document, attributes, {{"ROTATION", 3}}), "/accessors/3/type", "VEC4")),
              HasSubstr("EXT_mesh_gpu_instancing: ROTATION 0 is 0"));
}

// glTF: where the determinant is negative, front faces are clockwise.
TEST(GltfFile, MirrorImagesKeepTheirOutside) {
  const auto mesh = Parse(With(Document(), "/nodes/0/scale", {-1, 1, 1})).value();
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 2, 1}, Triangle{2, 3, 1}));
  EXPECT_THAT(mesh.positions[1], ElementsAre(-1, 0, 0));
  const auto twice = Parse(With(Document(), "/nodes/0/scale", {-1, -1, 1})).value();
  EXPECT_THAT(twice.triangles[0], ElementsAre(0, 1, 2));
  const auto instance =
      Parse(Instanced("SCALE", {{"componentType", 5126}, {"count", 1}, {"type", "VEC3"}}, BytesOf<float>({1, 1, -1})))
          .value();
  EXPECT_THAT(instance.triangles[0], ElementsAre(0, 2, 1));
}

TEST(GltfFile, TheCenterOfCesiumRtcMovesTheScene) {
  SortedJson document = With(Document(), "/extensionsRequired", {"CESIUM_RTC"});
  document["extensions"]["CESIUM_RTC"]["center"] = {6378137.1, 0, -1.5};
  document["nodes"][0]["scale"] = {2, 2, 2};
  EXPECT_THAT(Parse(document).value().positions[1], ElementsAre(6378137.1 + 2, 0, -1.5));
  EXPECT_THAT(Refusal(With(document, "/extensions/CESIUM_RTC/center", {1, 2})),
              HasSubstr("CESIUM_RTC: center is not 3 numbers"));
}

TEST(GltfFile, AFileWithoutAnySceneSaysSo) {
  EXPECT_EQ(Refusal(With(Document(), "/scenes", SortedJson::array())), "the file has no scene");
  SortedJson document = Document();
  document.erase("scenes");
  EXPECT_EQ(Refusal(document), "the file has no scene");
}

TEST(GltfFile, AnimationsMakeAWarning) {
  const SortedJson document = With(Document(), "/animations", {{{"channels", SortedJson::array()}}});
  EXPECT_THAT(Parse(document).value().warnings, ElementsAre(Warning{"ANIMATIONS", "1 animations are not applied"}));
}

// Linear 0.5 is 188 in sRGB.
TEST(GltfFile, ColorsAreVertexColorsTimesTheFactorInSrgb) {
  SortedJson document = Document(BytesOf<uint8_t>({255, 255, 255, 0, 255, 128, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
  document["accessors"].push_back(
      {{"bufferView", 2}, {"componentType", 5121}, {"normalized", true}, {"count", 4}, {"type", "VEC4"}});
  document["materials"] = {{{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0.5, 1}}}}}};
  SortedJson both = With(document, "/meshes/0/primitives/0/attributes/COLOR_0", 2);
  EXPECT_THAT(Parse(both).value().colors, ElementsAre(Color{255, 255, 255}, Color{255, 188, 0}, Color{}, Color{}));
  both["meshes"][0]["primitives"][0]["material"] = 0;
  EXPECT_THAT(Parse(both).value().colors, ElementsAre(Color{255, 0, 188}, Color{255, 0, 0}, Color{}, Color{}));
  SortedJson factor = With(document, "/meshes/0/primitives/0/material", 0);
  EXPECT_THAT(Parse(factor).value().colors, testing::Each(Color{255, 0, 188}));
  EXPECT_THAT(Parse(factor).value().warnings, IsEmpty());
  EXPECT_THAT(Parse(document).value().colors, IsEmpty());
}

TEST(GltfFile, TrianglesWithoutAColorAreWhiteBesideOthers) {
  SortedJson document = Document();
  SortedJson& primitives = document["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  primitives[1]["material"] = 0;
  document["materials"] = {
      {{"name", "wood"},
       {"pbrMetallicRoughness", {{"baseColorFactor", {0, 0, 0, 1}}, {"baseColorTexture", {{"index", 0}}}}}}};
  const Mesh mesh = Parse(document).value();
  ASSERT_EQ(mesh.colors.size(), 8);
  EXPECT_EQ(mesh.colors[0], (Color{255, 255, 255}));
  EXPECT_EQ(mesh.colors[4], (Color{0, 0, 0}));
  ASSERT_EQ(mesh.warnings.size(), 2);
  EXPECT_EQ(mesh.warnings[0].code, "TEXTURE_NOT_READ");
  EXPECT_EQ(mesh.warnings[0].element, "material \"wood\"");
  EXPECT_EQ(mesh.warnings[1].code, "PARTIAL_COLORS");
  EXPECT_THAT(mesh.warnings[1].message, HasSubstr("2 of 4 triangles"));
}

// Adds an accessor of `count` elements on `bytes`, which the document's accessor 2 and later ones share.
SortedJson WithAccessor(SortedJson document, int type, int offset, int count, const char* shape) {
  document["accessors"].push_back(
      {{"bufferView", 2}, {"byteOffset", offset}, {"componentType", type}, {"count", count}, {"type", shape}});
  return document;
}

TEST(GltfFile, MorphTargetsAreAppliedWithTheDefaultWeights) {
  const std::string moves = BytesOf<float>({0, 0, 4, 0, 0, 8, 0, 0, 0, 0, 0, 0});
  SortedJson document = WithAccessor(Document(moves), 5126, 0, 4, "VEC3");
  SortedJson& mesh = document["meshes"][0];
  mesh["primitives"][0]["targets"] = {{{"NORMAL", 99}}, {{"POSITION", 2}}};
  EXPECT_THAT(Parse(document).value().positions[1], ElementsAre(1, 0, 0));
  mesh["weights"] = {1, 0.25};
  EXPECT_THAT(Parse(document).value().positions[0], ElementsAre(0, 0, 1));
  EXPECT_THAT(Parse(document).value().positions[1], ElementsAre(1, 0, 2));
  // One mesh in two poses; the weights of a node count before those of its mesh.
  document["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"weights", {0, -1}}}};
  document["scenes"][0]["nodes"] = {0, 1};
  const Mesh both = Parse(document).value();
  EXPECT_THAT(both.positions[1], ElementsAre(1, 0, 2));
  EXPECT_THAT(both.positions[5], ElementsAre(1, 0, -8));
  EXPECT_THAT(both.warnings, IsEmpty());
  // A sparse target, which moves one vertex.
  document["accessors"][2] = {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}};
  document["accessors"][2]["sparse"] = {{"count", 1},
                                        {"indices", {{"bufferView", 1}, {"byteOffset", 2}, {"componentType", 5123}}},
                                        {"values", {{"bufferView", 2}}}};
  EXPECT_THAT(Parse(document).value().positions[1], ElementsAre(1, 0, 1));
  EXPECT_THAT(Refusal(With(document, "/accessors/2/count", 3)),
              HasSubstr("primitives[0]: targets[1]: POSITION has 3 elements of 3 components, not 4 of 3"));
}

// The square with two joints: joint 0 moves by (0, 0, 1) and joint 1, its child, by (0, 0, 2) more.
SortedJson Skinned() {
  const std::string joints = BytesOf<uint8_t>({0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0});
  const std::string weights = BytesOf<float>({1, 0, 0, 0, 2, 0, 0, 0, 1, 3, 0, 0, 0, 0, 0, 0});
  std::vector<float> inverse = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  inverse.insert(inverse.end(), {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 10, 0, 0, 1});
  SortedJson document = WithAccessor(Document(joints + weights + BytesOf(inverse)), 5121, 0, 4, "VEC4");
  document = WithAccessor(WithAccessor(document, 5126, 16, 4, "VEC4"), 5126, 80, 2, "MAT4");
  document["meshes"][0]["primitives"][0]["attributes"].update({{"JOINTS_0", 2}, {"WEIGHTS_0", 3}});
  document["nodes"] = {{{"mesh", 0}, {"skin", 0}, {"translation", {99, 99, 99}}},
                       {{"children", {2}}, {"translation", {0, 0, 1}}},
                       {{"translation", {0, 0, 2}}}};
  document["scenes"][0]["nodes"] = {0, 1};
  document["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", 4}}};
  return document;
}

TEST(GltfFile, SkinsAreAppliedInTheirDefaultPose) {
  const Mesh mesh = Parse(Skinned()).value();
  EXPECT_THAT(mesh.warnings, IsEmpty());
  EXPECT_THAT(mesh.positions[0], ElementsAre(0, 0, 1));
  EXPECT_THAT(mesh.positions[1], ElementsAre(11, 0, 3)) << "weights are divided by their sum";
  EXPECT_THAT(mesh.positions[2], ElementsAre(7.5, 1, 2.5));
  EXPECT_THAT(mesh.positions[3], ElementsAre(11, 1, 3)) << "without weights, the first joint counts";
  // Without matrices; joints outside the scene, which have their places all the same.
  SortedJson bare = Skinned();
  bare["skins"][0].erase("inverseBindMatrices");
  bare["scenes"][0]["nodes"] = {0};
  EXPECT_THAT(Parse(bare).value().positions[1], ElementsAre(1, 0, 3));
  SortedJson mirrored = With(bare, "/nodes/1/scale", {1, 1, -1});
  EXPECT_THAT(Parse(mirrored).value().triangles[0], ElementsAre(0, 2, 1));
}

TEST(GltfFile, ASkinOfAMeshWithoutJointsMakesAWarning) {
  SortedJson rigged =
      With(Document(), "/nodes", {{{"mesh", 0}, {"skin", 0}, {"scale", {2, 1, 1}}}, SortedJson::object()});
  rigged["skins"] = {{{"joints", {1}}}};
  const Mesh mesh = Parse(With(rigged, "/scenes/0/nodes", {0, 1})).value();
  EXPECT_THAT(mesh.positions[1], ElementsAre(2, 0, 0));
  ASSERT_EQ(mesh.warnings.size(), 1);
  EXPECT_EQ(mesh.warnings[0].code, "SKIN_WITHOUT_WEIGHTS");
}

TEST(GltfFile, SkinsThatDoNotFitAreRefused) {
  EXPECT_THAT(Refusal(With(Skinned(), "/skins/0/joints", {1})),
              HasSubstr("primitives[0]: vertex 1 has joint 1, which is not among the skin's 1"));
  EXPECT_THAT(Refusal(With(Skinned(), "/accessors/4/count", 1)),
              HasSubstr("nodes[0]: skins[0]: inverseBindMatrices has 16 numbers, not 16 for each of the 2 joints"));
  EXPECT_THAT(Refusal(With(Skinned(), "/accessors/3/count", 3)),
              HasSubstr("WEIGHTS_0 has 3 elements of 4 components, not 4 of 4"));
  EXPECT_THAT(Refusal(With(Skinned(), "/nodes/2/children", {1})),
              HasSubstr("skins[0]: nodes[1] is among its own ancestors"));
  EXPECT_THAT(Refusal(With(Skinned(), "/nodes/0/children", {2})), HasSubstr("nodes[2] has two parents"));
  EXPECT_THAT(Refusal(With(Skinned(), "/nodes/0/skin", 3)), HasSubstr("nodes[0]: skin 3 is not among the 1 skins"));
  EXPECT_THAT(Refusal(With(Skinned(), "/nodes/0/extensions",
                           {{"EXT_mesh_gpu_instancing", {{"attributes", SortedJson::object()}}}})),
              HasSubstr("a skin together with EXT_mesh_gpu_instancing is not defined"));
}

}  // namespace
}  // namespace latvox::client
