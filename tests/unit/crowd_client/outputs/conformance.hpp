#pragma once
// The tests of an output that need no knowledge of it.

#include "crowd_client/outputs/output_list.hpp"

namespace wade::crowd::testing {

// Fails the test at hand where an output
//   leaves no file, or one that it does not name, or an empty one
//   is not complete after finish(): finishing once more, as after the error of another one, changes it
//   differs between two runs of the same thing
//   needs more space at the end than it has said
//   lets an earlier run shine through
//   meets a full disk with anything but an OutputError, or cannot finish once there is space again
//   loses or spoils in a process that is killed what it had written
void check_output(const RegisteredOutput& output);

}  // namespace wade::crowd::testing
