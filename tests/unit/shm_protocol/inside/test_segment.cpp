#include <fcntl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "shm_protocol/inside/header.hpp"
#include "shm_protocol/inside/liveness.hpp"
#include "shm_protocol/inside/segment.hpp"
#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

std::string name_of(const Session& session) {
    return segment_name(session.name(), stream_fluid);
}

struct Foreign {
    const char* kind;
    std::function<bool(const std::string& path)> put;
};

bool put_socket(const std::string& path) {
    const int fd = socket(AF_UNIX, SOCK_STREAM, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
    const bool bound = bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    close(fd);
    return bound;
}

const Foreign foreign[] = {
    {"a FIFO", [](const std::string& path) { return mkfifo(path.c_str(), 0666) == 0; }},
    {"a directory", [](const std::string& path) { return mkdir(path.c_str(), 0777) == 0; }},
    {"a socket", put_socket},
    {"a symbolic link", [](const std::string& path) { return symlink("/etc/passwd", path.c_str()) == 0; }},
    {"a symbolic link", [](const std::string& path) { return symlink("nowhere", path.c_str()) == 0; }},
};

// A child with `limit` lowered to `value`, as `work` finds it.
int limited(int limit, rlim_t value, const std::function<int()>& work) {
    Child child([&] {
        const rlimit lowered{value, value};
        return setrlimit(static_cast<decltype(RLIMIT_NOFILE)>(limit), &lowered) == 0 ? work() : 77;
    });
    return child.wait();
}

}  // namespace

TEST_CASE("what is no plain file is refused by whoever meets its name, without a wait, and stays") {
    for (const Foreign& f : foreign) {
        const Session session;
        REQUIRE(f.put(session.path()));
        CAPTURE(f.kind);
        CHECK(contains(foreign_object(name_of(session)), f.kind));
        for (const Access access : {Access::read_only, Access::read_write})
            CHECK_THROWS_AS(SegmentFile::open(name_of(session), access), ForeignObject);
        const Caught joined = catch_error([&] { Subscriber(session.name(), "crowd", {.waiting = patient()}).leave(); });
        CHECK(joined.failure == Failure::protocol_violation);
        CHECK(contains(joined.text, f.kind));
        const Caught created = catch_error([&] { Publisher(session.name(), test_info(), patient()); });
        CHECK(created.failure == Failure::name_in_use);
        CHECK(contains(created.text, f.kind));
        CHECK_FALSE(has_living_producer(session.name(), stream_fluid));
        CHECK(std::filesystem::exists(std::filesystem::symlink_status(session.path())));
        std::filesystem::remove(session.path());
    }
}

TEST_CASE("a huge file with holes is judged by its header and not filled by looking at it") {
    const Session session;
    StreamInfo info = test_info();
    info.capacity = 0xFFFFFFFF;
    Header header = make_header(info, 1);
    const int fd = open(session.path().c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    REQUIRE(fd >= 0);
    REQUIRE(lock_byte(fd, producer_lock_byte));
    if (ftruncate(fd, static_cast<off_t>(header.total_bytes)) != 0) {
        WARN("skipped, no file may be that large");
        close(fd);
        return;
    }
    REQUIRE(pwrite(fd, &header, sizeof header, 0) == static_cast<ssize_t>(sizeof header));
    try {
        Subscriber(session.name(), "crowd", {.waiting = hasty()}).leave();
    } catch (const std::system_error& error) {
        CHECK(contains(error.what(), "bytes of shared memory"));  // no address space for it
    }
    struct stat about {};
    REQUIRE(fstat(fd, &about) == 0);
    CHECK(about.st_blocks * 512 < 1'000'000);
    close(fd);
}

TEST_CASE("where no file can be opened a producer says so and leaves no object") {
    bool failed = false, worked = false;
    for (rlim_t files = 3; files < 16; ++files) {
        const Session session;
        const int code = limited(RLIMIT_NOFILE, files, [&] {
            closefrom(3);
            try {
                const Publisher publisher(session.name(), test_info(), patient());
                return 0;
            } catch (const std::system_error& error) {
                return error.code().value() == EMFILE ? 1 : 2;
            }
        });
        CAPTURE(files);
        CHECK((code == 0 || code == 1));
        failed = failed || code == 1;
        worked = worked || code == 0;
        CHECK(access(session.path().c_str(), F_OK) != 0);
    }
    CHECK(failed);
    CHECK(worked);
}

TEST_CASE("a segment larger than a file may be is refused, not the end of the process") {
    for (const rlim_t bytes : {rlim_t{0}, rlim_t{8192}, rlim_t{100'000}}) {
        const Session session;
        const int code = limited(RLIMIT_FSIZE, bytes, [&] {
            try {
                const Publisher publisher(session.name(), test_info(), patient());
                return 0;
            } catch (const std::system_error& error) {
                return error.code().value() == EFBIG && contains(error.what(), "ulimit -f") ? 1 : 2;
            }
        });
        CAPTURE(bytes);
        CHECK(code == 1);
        CHECK(access(session.path().c_str(), F_OK) != 0);
    }
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // they need the address space themselves
TEST_CASE("where there is no address space to map a segment nothing is left of it") {
    const Session session;
    const int code = limited(RLIMIT_AS, 80'000'000, [&] {
        StreamInfo info = test_info();
        info.capacity = 1'500'000;  // 84 MB with two slots
        try {
            const Publisher publisher(session.name(), info, patient());
            return 0;
        } catch (const std::system_error& error) {
            return error.code().value() == ENOSPC || error.code().value() == ENOMEM || error.code().value() == EAGAIN
                       ? 1
                       : 2;
        }
    });
    CHECK(code == 1);
    CHECK(access(session.path().c_str(), F_OK) != 0);
}
#endif

TEST_CASE("a successor under the same name is not taken for the object that was opened, nor removed in its stead") {
    const Session session;
    const std::string name = segment_name(session.name(), stream_fluid);
    const auto old = SegmentFile::create_exclusive(name);
    REQUIRE(old);
    CHECK(old->is_named(name));
    CHECK_FALSE(SegmentFile::create_exclusive(name));
    unlink_segment(*old, name);
    CHECK_FALSE(old->is_named(name));
    const auto successor = SegmentFile::create_exclusive(name);
    REQUIRE(successor);
    CHECK_FALSE(old->is_named(name));
    unlink_segment(*old, name);
    CHECK(successor->is_named(name));
}
