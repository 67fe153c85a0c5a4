// The details of errors on the wire.
#ifndef LATVOX_TESTS_UNIT_SERVER_ERROR_DETAILS_H_
#define LATVOX_TESTS_UNIT_SERVER_ERROR_DETAILS_H_

#include <grpcpp/support/status.h>
#include <gtest/gtest.h>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace latvox {

inline google::rpc::Status DetailsOf(const grpc::Status& status) {
  google::rpc::Status details;
  EXPECT_TRUE(details.ParseFromString(status.error_details()));
  return details;
}

inline google::rpc::ErrorInfo ErrorInfoOf(const grpc::Status& status) {
  google::rpc::ErrorInfo info;
  const google::rpc::Status details = DetailsOf(status);
  EXPECT_TRUE(details.details_size() > 0 && details.details(0).UnpackTo(&info));
  return info;
}

}  // namespace latvox

#endif  // LATVOX_TESTS_UNIT_SERVER_ERROR_DETAILS_H_
