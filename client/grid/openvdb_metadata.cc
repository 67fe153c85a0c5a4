#include "client/grid/openvdb_metadata.h"

#include <openvdb/io/io.h>

#include <memory>
#include <sstream>
#include <stdexcept>

#include "client/grid/grid_metadata.h"
#include "client/grid/grid_transform.h"
#include "latvox/grid/voxel_grid.h"

namespace latvox::client {
namespace {

using Size = openvdb::Index32;  // of a value, which precedes its bytes

}  // namespace

openvdb::math::Transform::Ptr MakeTransform(const GridTransform& transform) {
  if (auto status = CheckGridTransform(transform); !status.ok())
    throw std::runtime_error(std::string(status.message()));
  std::istringstream bytes(TransformBytes(transform));
  openvdb::io::setCurrentVersion(bytes);
  auto made = std::make_shared<openvdb::math::Transform>();
  made->read(bytes);
  return made;
}

std::string MetadataText(const openvdb::Metadata& metadata) {
  const auto* number = dynamic_cast<const openvdb::DoubleMetadata*>(&metadata);
  return number == nullptr ? metadata.str() : MetadataText(ToMetadata(number->value()));
}

void Place(const GridTransform& transform, openvdb::GridBase& grid) {
  grid.setTransform(MakeTransform(transform));
  InsertMetadata(PlaceMetadata(transform), grid);
}

// The value is read from bytes in memory, where no length can lead OpenVDB beyond them.
openvdb::Metadata::Ptr ToOpenVdb(const MetadataValue& value) {
  const auto size = static_cast<Size>(value.bytes.size());
  std::istringstream bytes(std::string(reinterpret_cast<const char*>(&size), sizeof(size)) + value.bytes);
  openvdb::Metadata::Ptr made = openvdb::Metadata::createMetadata(value.type);
  made->read(bytes);
  return made;
}

void InsertMetadata(const Metadata& metadata, openvdb::GridBase& grid) {
  for (const auto& [name, value] : metadata) grid.insertMeta(name, *ToOpenVdb(value));
}

void InsertMetadata(const openvdb::MetaMap& metadata, openvdb::GridBase& grid) {
  for (auto each = metadata.beginMeta(); each != metadata.endMeta(); ++each) {
    const bool is_own =
        each->first == openvdb::GridBase::META_GRID_NAME || each->first == openvdb::GridBase::META_GRID_CLASS;
    if (!is_own) grid.insertMeta(each->first, *each->second);
  }
}

Metadata MetadataOf(const openvdb::MetaMap& metadata) {
  Metadata all;
  for (auto each = metadata.beginMeta(); each != metadata.endMeta(); ++each) {
    std::ostringstream bytes;
    each->second->write(bytes);
    all[each->first] = {each->second->typeName(), std::move(bytes).str().substr(sizeof(Size))};
  }
  return all;
}

}  // namespace latvox::client
