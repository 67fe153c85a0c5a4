#include "client/grid/metadata_texts.h"

#include "client/grid/grid_metadata.h"
#include "client/grid/names_metadata.h"
#include "client/grid/openvdb_trees.h"
#include "client/grid/request_metadata.h"
#include "client/grid/warning_metadata.h"

namespace latvox::client {

std::vector<std::pair<std::string, std::string>> MetadataTexts(const VoxelizeRequest& request, const MeshNote& note,
                                                               const CarriedNames& names, const Summary& summary) {
  openvdb::BoolGrid grid;
  DescribeRequest(request, note, grid);
  for (const Field field : request.fields) DescribeNames(names, field, grid);
  Describe(summary.certificate, grid);
  DescribeWarnings(summary.warnings, grid);
  std::vector<std::pair<std::string, std::string>> texts;
  for (auto meta = grid.beginMeta(); meta != grid.endMeta(); ++meta) {
    texts.emplace_back(meta->first, MetadataText(*meta->second));
  }
  return texts;
}

}  // namespace latvox::client
