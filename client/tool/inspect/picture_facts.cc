#include "client/tool/inspect/picture_facts.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>

#include "absl/strings/match.h"

namespace latvox::client {
namespace {

constexpr size_t kMostText = size_t{1} << 20;

uint32_t BigEndian(const char* bytes) {
  uint32_t word = 0;
  for (size_t n = 0; n < 4; ++n) word = word << 8 | static_cast<uint8_t>(bytes[n]);
  return word;
}

// Adds the corners of the surface, in the frame of its node, to the facts.
Json BoundsOf(const Json& root) {
  const auto at = root.at("nodes").at(0).at("translation").get<std::array<double, 3>>();
  const Json& positions = root.at("accessors").at(0);
  auto low = positions.at("min").get<std::array<double, 3>>(), high = positions.at("max").get<std::array<double, 3>>();
  for (size_t m = 0; m < 3; ++m) {
    low[m] += at[m];
    high[m] += at[m];
  }
  return {{"min", low}, {"max", high}};
}

Json FactsOfSurface(const Json& root) {
  Json facts = root.at("extras");
  if (!root.contains("meshes")) {
    facts["triangles"] = 0;
    return facts;
  }
  facts["triangles"] = root.at("accessors").at(1).at("count").get<uint64_t>() / 3;
  facts["corners"] = root.at("accessors").at(0).at("count").get<uint64_t>();
  facts["bounds"] = BoundsOf(root);
  return facts;
}

// Returns whether the file ends like a page. `text` was read from its front.
bool CheckEndOfPage(const std::string& text, FileSource& file) {
  const std::string end = "</html>\n";
  const uint64_t left = file.size() - file.at();
  if (left > end.size() && !file.Skip(left - end.size()).ok()) return false;
  std::string rest(std::min<uint64_t>(left, end.size()), '\0');
  return file.Read(rest.data(), rest.size()).ok() && absl::EndsWith(text + rest, end);
}

}  // namespace

absl::StatusOr<Json> PngFacts(FileSource& file) {
  std::array<char, 8> head;
  if (auto status = file.Read(head.data(), head.size()); !status.ok()) return status;
  if (absl::string_view(head.data(), 8) != "\x89PNG\r\n\x1a\n") return file.Bad("is not a .png file");
  Json facts;
  for (bool end = false; !end;) {  // a chunk: length, type, content, checksum
    if (auto status = file.Read(head.data(), head.size()); !status.ok()) return status;
    const absl::string_view type(&head[4], 4);
    uint64_t rest = uint64_t{BigEndian(head.data())} + 4;
    if (facts.empty()) {
      std::array<char, 8> size;
      if (type != "IHDR" || rest < 8) return file.Bad("does not begin with its size");
      if (auto status = file.Read(size.data(), size.size()); !status.ok()) return status;
      facts = {{"width", BigEndian(size.data())}, {"height", BigEndian(&size[4])}};
      rest -= 8;
    }
    if (auto status = file.Skip(rest); !status.ok()) return status;
    end = type == "IEND";
  }
  return facts;
}

absl::StatusOr<Json> PageFacts(FileSource& file) {
  const std::string first = "<script id=\"data\" type=\"application/json\">";
  std::string text(std::min<uint64_t>(kMostText, file.size()), '\0');
  if (auto status = file.Read(text.data(), text.size()); !status.ok()) return status;
  const size_t begin = text.find(first), end = text.find("</script>", begin);
  if (!absl::StartsWith(text, "<!doctype html>") || end == std::string::npos) {
    return file.Bad("is not a page of latvox view");
  }
  try {
    const Json data = Json::parse(text.substr(begin + first.size(), end - begin - first.size()));
    Json facts = {{"title", data.at("title").get<std::string>()},
                  {"voxels", data.at("voxels").get<uint64_t>()},
                  {"index_box", {{"min", data.at("low")}, {"max", data.at("high")}}},
                  {"colors", Json::array()},
                  {"metadata", Json::object()}};
    if (facts["voxels"] == 0) facts["index_box"] = Json();
    for (const Json& paint : data.at("paints")) facts["colors"].push_back(paint.at("name"));
    for (const Json& field : data.at("metadata")) facts["metadata"][field.at(0).get<std::string>()] = field.at(1);
    return CheckEndOfPage(text, file) ? absl::StatusOr<Json>(facts) : file.Bad("is cut short");
  } catch (const Json::exception& error) {
    return file.Bad("is not a page of this version of latvox view (", error.what(), ")");
  }
}

absl::StatusOr<std::optional<Json>> SurfaceFacts(FileSource& file) {
  std::array<uint32_t, 5> head;  // "glTF", version, bytes of the file, bytes of the JSON, "JSON"
  if (auto status = file.Read(head.data(), sizeof(head)); !status.ok()) return status;
  if (head[0] != 0x46546C67 || head[4] != 0x4E4F534A) return file.Bad("is not a .glb file");
  if (head[3] > kMostText) return std::nullopt;  // latvox writes less
  std::string text(head[3], '\0');
  if (auto status = file.Read(text.data(), text.size()); !status.ok()) return status;
  try {
    const Json root = Json::parse(text);
    const std::string generator = root.at("asset").value("generator", "");
    if (!absl::StartsWith(generator, "latvox ") || !root.contains("extras")) return std::nullopt;
    if (head[2] != file.size()) return file.Bad("is cut short, or goes on after its content");
    return FactsOfSurface(root);
  } catch (const Json::exception& error) {
    return file.Bad("has no JSON of glTF (", error.what(), ")");
  }
}

}  // namespace latvox::client
