// glTF that is legal, and glTF that is not.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "client/mesh/mesh_encoder.h"
#include "client/mesh_files/gltf_file.h"
#include "client/mesh_files/obj_file.h"
#include "tests/unit/client/files.h"
#include "tests/unit/client/mesh_files/gltf_document.h"

namespace latvox::client {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

TEST(GltfFile, WhatPlacesNoVertexIsNotLookedAt) {
  const Mesh wanted = Parse(Document()).value();
  EXPECT_THAT(wanted.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 3}));
  const auto reads = [&](const SortedJson& document) {
    const auto mesh = Parse(document);
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_EQ(mesh->positions, wanted.positions);
    EXPECT_EQ(mesh->triangles, wanted.triangles);
    EXPECT_THAT(mesh->warnings, IsEmpty());
  };
  reads(With(Document(), "/nodes/0/camera", 7));
  reads(With(Document(), "/images", {{{"uri", "missing.png"}}}));
  reads(With(Document(), "/meshes/0/primitives/0/attributes/NORMAL", 99));
  reads(With(Document(), "/accessors/0/count", 4.0));
  reads(With(Document(), "/meshes/0/weights", {0, 0.0}));
}

TEST(GltfFile, IntegersAreDecodedAsQuantizationHasThem) {
  const auto coordinates = [](int type, bool normalized, const std::string& bytes) {
    SortedJson document = Document(bytes);
    document["accessors"][0] = {
        {"bufferView", 2}, {"componentType", type}, {"normalized", normalized}, {"count", 4}, {"type", "VEC3"}};
    document["bufferViews"][2]["byteStride"] = bytes.size() / 4;
    document["extensionsRequired"] = {"KHR_mesh_quantization"};
    return Parse(document).value().positions[1];
  };
  const std::string i8 = BytesOf<int8_t>({9, 9, 9, 9, -128, -127, 64, 9, 9, 9, 9, 9, 9, 9, 9, 9});
  const std::string u8 = BytesOf<uint8_t>({9, 9, 9, 9, 255, 0, 51, 9, 9, 9, 9, 9, 9, 9, 9, 9});
  const std::string i16 = BytesOf<int16_t>({9, 9, 9, 9, -32768, 32767, -7, 9, 9, 9, 9, 9, 9, 9, 9, 9});
  const std::string u16 = BytesOf<uint16_t>({9, 9, 9, 9, 65535, 1, 40000, 9, 9, 9, 9, 9, 9, 9, 9, 9});
  EXPECT_THAT(coordinates(5120, false, i8), ElementsAre(-128, -127, 64));
  EXPECT_THAT(coordinates(5120, true, i8), ElementsAre(-1, -1, 64 / 127.0));
  EXPECT_THAT(coordinates(5121, false, u8), ElementsAre(255, 0, 51));
  EXPECT_THAT(coordinates(5121, true, u8), ElementsAre(1, 0, 0.2));
  EXPECT_THAT(coordinates(5122, false, i16), ElementsAre(-32768, 32767, -7));
  EXPECT_THAT(coordinates(5122, true, i16), ElementsAre(-1, 1, -7 / 32767.0));
  EXPECT_THAT(coordinates(5123, false, u16), ElementsAre(65535, 1, 40000));
  EXPECT_THAT(coordinates(5123, true, u16), ElementsAre(1, 1 / 65535.0, 40000 / 65535.0));
}

TEST(GltfFile, StripsAndFansKeepTheirSenseAndWhatHasNoSurfaceIsCounted) {
  const auto in_mode = [](int mode, int corners) {
    return Parse(With(With(Document(), "/meshes/0/primitives/0/mode", mode), "/accessors/1/count", corners)).value();
  };
  EXPECT_THAT(in_mode(5, 4).triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 2, 2}));
  EXPECT_THAT(in_mode(5, 6).triangles[2], ElementsAre(2, 2, 1));
  EXPECT_THAT(in_mode(5, 6).triangles[3], ElementsAre(2, 3, 1));
  EXPECT_THAT(in_mode(6, 4).triangles, ElementsAre(Triangle{1, 2, 0}, Triangle{2, 2, 0}));
  EXPECT_THAT(in_mode(5, 2).triangles, IsEmpty());
  const std::array<uint64_t, 4> counts{6, 3, 6, 5};
  for (int mode = 0; mode < 4; ++mode) {
    EXPECT_EQ(in_mode(mode, 6).skipped, counts[static_cast<size_t>(mode)]) << mode;
    EXPECT_THAT(in_mode(mode, 6).triangles, IsEmpty());
  }
  // Without indices; without a buffer view, so that all are 0; without positions.
  SortedJson document = Document();
  document["meshes"][0]["primitives"][0].erase("indices");
  EXPECT_THAT(Parse(With(document, "/accessors/0/count", 3)).value().triangles, ElementsAre(Triangle{0, 1, 2}));
  document = Document();
  document["accessors"][0].erase("bufferView");
  EXPECT_THAT(Parse(document).value().positions[3], ElementsAre(0, 0, 0));
  EXPECT_THAT(Parse(With(Document(), "/meshes/0/primitives/0/attributes", SortedJson::object())).value().triangles,
              IsEmpty());
}

// A cube of floats that a node moves to geocentric coordinates, where floats are half a meter apart.
TEST(GltfFile, TranslationsAreDoubles) {
  const SortedJson place = {4395452.3, 1407346.02, -4400722.85};
  const Mesh mesh = Parse(With(Document(), "/nodes/0/translation", place)).value();
  EXPECT_THAT(mesh.positions[0], ElementsAre(4395452.3, 1407346.02, -4400722.85));
  EXPECT_THAT(mesh.positions[3], ElementsAre(4395452.3 + 1, 1407346.02 + 1, -4400722.85));
}

TEST(GltfFile, NodesPlaceTheirMeshesAndAreTrees) {
  const auto corner = [](const SortedJson& node) {
    return Parse(With(Document(), "/nodes/0", node)).value().positions[1];
  };
  // A quarter turn about z, whose quaternion is not exactly a unit.
  const SortedJson turn = {0, 0, 0.70711, 0.70711};
  EXPECT_THAT(corner({{"mesh", 0}, {"rotation", turn}, {"scale", {3, 1, 1}}}), ElementsAre(0, 3, 0));
  EXPECT_THAT(corner({{"mesh", 0}, {"matrix", {0, 2, 5, 0, 0, 0, 0, 0, 0, 0, 0, 0, 10, 20, 30, 1}}}),
              ElementsAre(10, 22, 35));
  EXPECT_THAT(Refusal(With(Document(), "/nodes/0/matrix", {1, 2, 3})), HasSubstr("nodes[0]: matrix is not 16 numbers"));
  EXPECT_THAT(Refusal(With(Document(), "/nodes/0/rotation", {0, 0, 0, 0})), HasSubstr("nodes[0]: rotation is 0"));
  EXPECT_THAT(Refusal(With(Document(), "/nodes", {{{"children", {1}}}, {{"children", {0}}}})),
              HasSubstr("nodes[1]: children 0 is in the scene already"));
  EXPECT_THAT(Refusal(With(Document(), "/scenes/0/nodes", {0, 0})), HasSubstr("scenes[0]: nodes 0 is in the scene"));
  SortedJson chain = SortedJson::array();
  for (int n = 1; n < 20000; ++n) chain.push_back({{"children", {n}}, {"translation", {1, 0, 0}}});
  chain.push_back({{"mesh", 0}});
  EXPECT_THAT(Parse(With(Document(), "/nodes", chain)).value().positions[0], ElementsAre(19999, 0, 0));
}

TEST(GltfFile, ExtensionsThatAReaderMustKnowAreRefusedUnlessTheyLeaveTrianglesAlone) {
  const auto required = [](const char* name) { return With(Document(), "/extensionsRequired", {name}); };
  for (const char* name :
       {"KHR_draco_mesh_compression", "KHR_mesh_quantization", "KHR_materials_unlit", "KHR_texture_transform",
        "KHR_technique_webgl", "KHR_texture_basisu", "EXT_mesh_gpu_instancing", "EXT_texture_webp",
        "KHR_lights_punctual", "EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    EXPECT_TRUE(Parse(required(name)).ok()) << name;
  }
  for (const char* name : {"KHR_node_visibility", "ACME_shape"}) {
    EXPECT_EQ(Refusal(required(name)), absl::StrCat("extensionsRequired: ", name, " is not supported"));
  }
  const auto used = [](const char* name) {
    return Parse(With(Document(), "/extensionsUsed", {name})).value().warnings;
  };
  EXPECT_THAT(
      used("ACME_shape"),
      ElementsAre(Warning{"UNKNOWN_EXTENSION",
                          "extensionsUsed: ACME_shape is not read, and may place or change triangles", "ACME_shape"}));
  for (const char* name : {"KHR_materials_unlit", "EXT_mesh_gpu_instancing", "EXT_meshopt_compression", "MSFT_lod"}) {
    EXPECT_THAT(used(name), IsEmpty()) << name;
  }
}

TEST(GltfFile, ErrorsNamePlaceValueAndLimit) {
  const auto says = [](const char* place, const SortedJson& value, const char* text) {
    const auto status = Parse(With(Document(), place, value)).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << place;
    EXPECT_THAT(std::string(status.message()), HasSubstr(text));
  };
  says("/asset/version", "1.0", "asset.version \"1.0\" is not 2.0");
  says("/asset/minVersion", "2.1", "asset.minVersion \"2.1\" is not 2.0");
  says("/asset", SortedJson::object(), "key 'version' not found");
  says("/scene", 1, "scene 1 is not among the 1 scenes");
  says("/nodes", "none", "JSON: ");
  says("/nodes/0/mesh", 1, "nodes[0]: mesh 1 is not among the 1 meshes");
  says("/nodes/0/mesh", -1, "nodes[0]: mesh: -1 is not a whole number");
  says("/meshes/0/primitives", 3, "meshes[0].primitives[0]: JSON: ");
  says("/meshes/0/primitives/0/mode", 7, "primitives[0]: mode 7 exceeds 6");
  says("/meshes/0/primitives/0/material", 5, "primitives[0]: material 5 is not among the 0 materials");
  says("/meshes/0/primitives/0/attributes/COLOR_0", 1, "COLOR_0 has 6 elements of 1 components, not 4 of 3 or 4");
  says("/accessors/0/type", "VEC2", "POSITION has 2 components, not 3");
  says("/accessors/0/type", "MAT3", "accessors[0]: type \"MAT3\" is not one of SCALAR");
  says("/accessors/0/componentType", 5125, "accessors[0]: componentType 5125 is not one of 5120, 5121");
  says("/accessors/0/componentType", 5124, "accessors[0]: componentType 5124 is not one of glTF's");
  says("/accessors/0/count", 5, "accessors[0]: needs bytes 0 to 60 of bufferView 0, which has 48");
  says("/accessors/0/count", 4294967296, "accessors[0]: count 4294967296 exceeds 4294967295");
  says("/accessors/1/componentType", 5126, "accessors[1]: ");
  says("/accessors/1/componentType", 5122, "indices are \"SCALAR\" of componentType 5122");
  says("/bufferViews/0/byteStride", 8, "byteStride 8 is not within 12, the size of an element, and 252");
  says("/bufferViews/1/byteOffset", 50, "bufferViews[1] ends at byte 62 of buffer 0, which has 60");
  says("/bufferViews/1/buffer", 3, "bufferViews[1]: buffer 3 is not among the 1 buffers");
  says("/buffers/0/byteLength", 99, "buffers[0] has 60 bytes, not 99");
  says("/buffers/0/uri", "/dev/zero", "buffers[0]: file \"/dev/zero\" cannot be read");
  says("/buffers/0/uri", "data:,abc", "buffers[0]: its data: URI is not base64");
  says("/nodes/0", {{"mesh", 0}, {"scale", {1e308, 1, 1}}, {"translation", {1e308, 0, 0}}},
       "meshes[0].primitives[0]: vertex 1 is not finite (inf 0 0)");
}

TEST(GltfFile, BrokenTrianglesAreLeftOutIfAsked) {
  const auto skipped = [](const SortedJson& document) {
    return ParseGltf(document.dump(), "", {.skip_bad = true}).value();
  };
  const Mesh three = skipped(With(Document(), "/accessors/0/count", 3));
  EXPECT_THAT(three.triangles, ElementsAre(Triangle{0, 1, 2}));
  ASSERT_EQ(three.warnings.size(), 1);
  EXPECT_EQ(three.warnings[0].code, "BAD_ELEMENTS");
  EXPECT_THAT(three.warnings[0].message, HasSubstr("vertex index 3 of triangle 1 is not within the 3 vertices"));
  const SortedJson far = {{"mesh", 0}, {"scale", {1e308, 1, 1}}, {"translation", {1e308, 0, 0}}};
  const Mesh finite = skipped(With(Document(), "/nodes/0", far));
  EXPECT_THAT(finite.triangles, IsEmpty());
  EXPECT_EQ(finite.positions.size(), 2);
}

// A few bytes may place a mesh many times, or name a primitive many times.
TEST(GltfFile, ScenesAreOnlySoLarge) {
  SortedJson placed = Document();
  placed["nodes"].push_back({{"mesh", 0}});
  placed["nodes"].push_back({{"mesh", 0}});
  placed["scenes"][0]["nodes"] = {0, 1, 2};
  EXPECT_TRUE(ParseGltf(placed.dump(), "", {}, 12).ok());
  const absl::Status status = ParseGltf(placed.dump(), "", {}, 11).status();
  EXPECT_EQ(status,
            absl::ResourceExhaustedError("meshes[0].primitives[0]: the scene has more than 11 triangles or vertices"));

  SortedJson repeated = Document();
  SortedJson& primitives = repeated["meshes"][0]["primitives"];
  primitives.push_back(primitives[0]);
  EXPECT_TRUE(ParseGltf(repeated.dump(), "", {}, 8).ok());
  EXPECT_EQ(ParseGltf(repeated.dump(), "", {}, 7).status().code(), absl::StatusCode::kResourceExhausted);

  // Meshes without triangles do not count and are not kept.
  SortedJson points = With(repeated, "/meshes/0/primitives/0/mode", 0);
  EXPECT_TRUE(ParseGltf(points.dump(), "", {}, 4).ok());
}

class GltfFiles : public FilesTest {};

TEST_F(GltfFiles, UrisArePercentEncoded) {
  SortedJson document = Document();
  const std::string buffer = BufferOf(document);
  const std::filesystem::path folder = std::filesystem::path(Write("a b%.bin", buffer)).parent_path();
  document["buffers"][0]["uri"] = "a%20b%.bin";
  EXPECT_TRUE(ParseGltf(document.dump(), folder).ok());
  document["buffers"][0]["uri"] = "a%2520b%25.bin";
  EXPECT_THAT(std::string(ParseGltf(document.dump(), folder).status().message()),
              HasSubstr("buffers[0]: file \"a%2520b%25.bin\" cannot be read"));
}

TEST_F(GltfFiles, UrisMayHaveBackslashes) {
  SortedJson document = Document();
  const std::filesystem::path folder = std::filesystem::path(Write("a.bin", BufferOf(document))).parent_path();
  for (const char* uri : {".\\a.bin", "x\\..\\a.bin", ".%5Ca.bin"}) {
    std::filesystem::create_directory(folder / "x");
    document["buffers"][0]["uri"] = uri;
    EXPECT_TRUE(ParseGltf(document.dump(), folder).ok()) << uri;
  }
}

std::string Chunk(absl::string_view kind, absl::string_view bytes) {
  return absl::StrCat(BytesOf<uint32_t>({static_cast<uint32_t>(bytes.size())}), kind, bytes);
}

TEST(GltfFile, ContainersHaveOneBinaryChunkAndMayHaveOthers) {
  SortedJson document = Document();
  const std::string buffer = BufferOf(document);
  document["buffers"][0].erase("uri");
  const auto parse = [&](uint32_t version, const std::string& chunks) {
    const auto length = static_cast<uint32_t>(12 + chunks.size());
    return ParseGltf(absl::StrCat("glTF", BytesOf<uint32_t>({version, length}), chunks), "");
  };
  const std::string json = Chunk("JSON", document.dump()), binary = Chunk(absl::string_view("BIN\0", 4), buffer);
  EXPECT_TRUE(parse(2, json + binary).ok());
  EXPECT_TRUE(parse(2, json + binary + Chunk("MORE", "more")).ok());
  EXPECT_THAT(std::string(parse(2, json + Chunk("MORE", buffer)).status().message()),
              HasSubstr("buffers[0] has no uri, and is not the binary chunk"));
  EXPECT_THAT(std::string(parse(1, json + binary).status().message()),
              HasSubstr("version 1 of the container is not 2"));
}

// Positions and colors have the ids of the stream, which are their indices in it.
TEST(GltfFile, DracoStreamsAreDecoded) {
  const Mesh quad = ParseObj("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nv 1 1 0 1 1 0\nf 1 2 3\nf 3 2 4\n").value();
  const std::string drc = EncodeMesh(quad, 0, {Field::kColor}).value().drc;
  SortedJson document = Document(drc);
  SortedJson& primitive = document["meshes"][0]["primitives"][0];
  primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", 2},
                                                           {"attributes", {{"POSITION", 0}, {"COLOR_0", 1}}}};
  document["accessors"][0].erase("bufferView");
  const auto mesh = Parse(document);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->triangles.size(), 2);
  ASSERT_EQ(mesh->colors.size(), mesh->positions.size());
  for (size_t v = 0; v < mesh->positions.size(); ++v) {
    const auto found = std::find(quad.positions.begin(), quad.positions.end(), mesh->positions[v]);
    ASSERT_NE(found, quad.positions.end());
    EXPECT_EQ(mesh->colors[v], quad.colors[static_cast<size_t>(found - quad.positions.begin())]);
  }
  EXPECT_THAT(Refusal(With(document, "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression/bufferView", 0)),
              StartsWith("meshes[0].primitives[0]: KHR_draco_mesh_compression: is not a Draco mesh"));
}

}  // namespace
}  // namespace latvox::client
