#include "shm_protocol/inside/liveness.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

namespace wade::shm {
namespace {

struct flock one_byte(short type, std::uint64_t byte) {
    struct flock lock {};  // l_pid must be 0 for OFD locks
    lock.l_type = type;
    lock.l_whence = SEEK_SET;
    lock.l_start = static_cast<off_t>(byte);
    lock.l_len = 1;
    return lock;
}

}  // namespace

bool lock_byte(int fd, std::uint64_t byte) {
    struct flock lock = one_byte(F_WRLCK, byte);
    if (fcntl(fd, F_OFD_SETLK, &lock) == 0) return true;
    if (errno == EAGAIN || errno == EACCES) return false;
    throw std::system_error(errno, std::generic_category(), "locking a byte of the shared-memory segment");
}

void unlock_byte(int fd, std::uint64_t byte) noexcept {
    struct flock lock = one_byte(F_UNLCK, byte);
    fcntl(fd, F_OFD_SETLK, &lock);
}

bool is_locked_by_other(int fd, std::uint64_t byte) {
    struct flock lock = one_byte(F_WRLCK, byte);
    if (fcntl(fd, F_OFD_GETLK, &lock) != 0)
        throw std::system_error(errno, std::generic_category(), "probing a lock of the shared-memory segment");
    return lock.l_type != F_UNLCK;
}

std::uint64_t process_start_time() {
    std::ifstream stat("/proc/self/stat");
    std::string line;
    std::getline(stat, line);
    const std::size_t end_of_name = line.rfind(')');  // the name may hold spaces and parentheses
    if (end_of_name == std::string::npos) return 0;
    std::istringstream rest(line.substr(end_of_name + 1));
    std::string field;
    for (int i = 3; i < 22; ++i) rest >> field;  // proc(5): field 22 is starttime
    std::uint64_t start = 0;
    return rest >> start ? start : 0;
}

}  // namespace wade::shm
