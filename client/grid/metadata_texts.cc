#include "client/grid/metadata_texts.h"

#include "client/grid/grid_metadata.h"
#include "client/grid/names_metadata.h"
#include "client/grid/request_metadata.h"
#include "client/grid/warning_metadata.h"

namespace latvox::client {

std::vector<std::pair<std::string, std::string>> MetadataTexts(const VoxelizeRequest& request, const MeshNote& note,
                                                               const CarriedNames& names, const Summary& summary) {
  Metadata metadata = RequestMetadata(request, note);
  for (const Field field : request.fields) metadata.merge(NamesMetadata(names, field));
  metadata.merge(CertificateMetadata(summary.certificate));
  metadata.merge(WarningMetadata(summary.warnings));
  std::vector<std::pair<std::string, std::string>> texts;
  for (const auto& [name, value] : metadata) texts.emplace_back(name, MetadataText(value));
  return texts;
}

}  // namespace latvox::client
