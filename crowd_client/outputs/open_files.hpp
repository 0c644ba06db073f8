#pragma once
// How many files many crowds may keep open at once.

#include <cstddef>
#include <span>

namespace wade::crowd {

// Raises the limit of open files of this process, so that crowds that keep as many open each as `per_crowd` says have
// room: up to five each, where the usual limit of 1024 would end at some 200 crowds.
// Throws ConfigurationError if even the largest limit that the process may have is too low.
void allow_open_files(std::span<const std::size_t> per_crowd);

}  // namespace wade::crowd
