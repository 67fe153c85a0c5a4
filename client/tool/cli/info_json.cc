#include "client/tool/cli/info_json.h"

#include "client/json/json.h"

namespace latvox::client {

std::string ToJson(const GridFileInfo& info) {
  const auto& [a, b, c] = info.transform.basis;
  Json json = {{"grid", {{"name", info.name}, {"type", info.value_type}}},
               {"voxels", info.active_voxels},
               {"index_box", nullptr},
               {"voxel_size", info.transform.voxel_size},
               {"basis", {a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]}},
               {"origin", info.transform.origin},
               {"metadata", Json::object()}};
  if (const auto& box = info.active_box) json["index_box"] = {{"min", box->min}, {"max", box->max}};
  for (const auto& [name, value] : info.metadata) json["metadata"][name] = value;
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace latvox::client
