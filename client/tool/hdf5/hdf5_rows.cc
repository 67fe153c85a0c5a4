#include "client/tool/hdf5/hdf5_rows.h"

#include <algorithm>
#include <array>

namespace latvox::client {
namespace {

constexpr size_t kChunkRows = 65536;

}  // namespace

Hdf5Rows::Hdf5Rows(const Hdf5& hdf5, hid_t place, const Hdf5Form& form)
    : hdf5_(&hdf5),
      type_(form.type),
      row_bytes_(form.type_bytes * form.columns),
      columns_(form.columns),
      is_flat_(form.is_flat && form.columns == 1) {
  constexpr unsigned kDeflateLevel = 1;  // the fastest
  const int ranks = is_flat_ ? 1 : 2;
  const std::array<hsize_t, 2> none = {0, columns_}, most = {H5S_UNLIMITED, columns_}, chunk = {kChunkRows, columns_};
  const Hdf5Id list(hdf5.H5Pcreate(hdf5.H5P_CLS_DATASET_CREATE_ID_g), hdf5.H5Pclose);
  const Hdf5Id space(hdf5.H5Screate_simple(ranks, none.data(), most.data()), hdf5.H5Sclose);
  // A time in the file would make equal jobs write different files.
  good_ = list.ok() && space.ok() && hdf5.H5Pset_chunk(list.get(), ranks, chunk.data()) >= 0 &&
          hdf5.H5Pset_shuffle(list.get()) >= 0 && hdf5.H5Pset_deflate(list.get(), kDeflateLevel) >= 0 &&
          hdf5.H5Pset_obj_track_times(list.get(), false) >= 0;
  if (!good_) return;
  set_ = {hdf5.H5Dcreate2(place, form.name.c_str(), type_, space.get(), H5P_DEFAULT, list.get(), H5P_DEFAULT),
          hdf5.H5Dclose};
  good_ = set_.ok();
}

void Hdf5Rows::Append(const void* rows, size_t bytes) {
  const auto* from = static_cast<const char*>(rows);
  while (bytes > 0) {
    const size_t now = std::min(bytes, kChunkRows * row_bytes_ - waiting_.size());
    waiting_.append(from, now);
    from += now;
    bytes -= now;
    if (waiting_.size() == kChunkRows * row_bytes_) Write();
  }
}

bool Hdf5Rows::Finish() {
  Write();
  set_ = {};
  return good_;
}

void Hdf5Rows::Write() {
  const hsize_t count = waiting_.size() / row_bytes_;
  if (good_ && count > 0) {
    const int ranks = is_flat_ ? 1 : 2;
    const std::array<hsize_t, 2> all = {written_ + count, columns_}, first = {written_, 0}, now = {count, columns_};
    good_ = hdf5_->H5Dset_extent(set_.get(), all.data()) >= 0;
    const Hdf5Id file(hdf5_->H5Dget_space(set_.get()), hdf5_->H5Sclose);
    const Hdf5Id memory(hdf5_->H5Screate_simple(ranks, now.data(), nullptr), hdf5_->H5Sclose);
    good_ = good_ && file.ok() && memory.ok() &&
            hdf5_->H5Sselect_hyperslab(file.get(), H5S_SELECT_SET, first.data(), nullptr, now.data(), nullptr) >= 0 &&
            hdf5_->H5Dwrite(set_.get(), type_, memory.get(), file.get(), H5P_DEFAULT, waiting_.data()) >= 0;
  }
  written_ += count;
  waiting_.clear();
}

}  // namespace latvox::client
