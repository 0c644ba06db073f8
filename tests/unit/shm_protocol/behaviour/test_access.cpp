// Access to a segment: for its owner, and for its owner's group if both sides ask for that. Tests with a second user or
// a file system of their own need root; without root they warn and are skipped.

#include <fcntl.h>
#include <grp.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <stdexcept>
#include <system_error>

#include "support.hpp"

using namespace wade::shm;
using namespace wade::shm::test;

namespace {

constexpr uid_t stranger = 65534;
constexpr gid_t strange_group = 65534;
constexpr int impossible = 77;  // the system does not let the child do what the test needs

bool is_root(const char* what) {
    if (geteuid() == 0) return true;
    WARN("skipped, needs root: " << what);
    return false;
}

// Runs `work` as another user. Its group may be the one of this process.
int as_stranger(gid_t group, const std::function<int()>& work) {
    Child child([&] {
        if (setgroups(0, nullptr) != 0 || setgid(group) != 0 || setuid(stranger) != 0) return impossible;
        return work();
    });
    return child.wait();
}

int code_of(Failure failure) {
    return static_cast<int>(failure);
}

mode_t mode_of(const std::string& path) {
    struct stat about {};
    return stat(path.c_str(), &about) == 0 ? about.st_mode & 0777 : 0;
}

StreamInfo shared_info() {
    StreamInfo info = test_info();
    info.group_access = true;
    return info;
}

int join_and_leave(const Session& session, bool group_access) {
    Subscriber(session.name(), "crowd", {.waiting = hasty(), .group_access = group_access}).leave();
    return 0;
}

}  // namespace

TEST_CASE("a segment is open to its group only on request, whatever the mask for new files") {
    const mode_t mask = umask(077);
    const Session session;
    {
        const Publisher publisher(session.name(), shared_info(), patient());
        CHECK(mode_of(session.path()) == 0660);
        CHECK(publisher.info().group_access);
        CHECK(join_and_leave(session, false) == 0);  // its owner needs no request
    }
    const Publisher publisher(session.name(), test_info(), patient());
    CHECK(mode_of(session.path()) == 0600);
    umask(mask);
}

TEST_CASE("another user's segment is refused at once, as a stream and as a name") {
    if (!is_root("another user's segment")) return;
    const Session session;
    const Publisher publisher(session.name(), test_info(), patient());
    CHECK(as_stranger(strange_group, [&] { return join_and_leave(session, false); }) ==
          code_of(Failure::protocol_violation));
    CHECK(as_stranger(strange_group, [&] {
              const Publisher second(session.name(), test_info(), patient());
              return 0;
          }) == code_of(Failure::name_in_use));
}

TEST_CASE("even a user who can open everything does not trust or replace another user's segment") {
    if (!is_root("root and another user's segment")) return;
    for (const mode_t mode : {mode_t{0600}, mode_t{0660}}) {  // the group is none of this process's
        const Session session;
        REQUIRE(as_stranger(strange_group, [&] {
                    const int fd = open(session.path().c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
                    return fd >= 0 && ftruncate(fd, 4096) == 0 && fchmod(fd, mode) == 0 ? 0 : impossible;
                }) == 0);
        const Caught joined = catch_error([&] { join_and_leave(session, false); });
        CHECK(joined.failure == Failure::protocol_violation);
        CHECK(contains(joined.text, "belongs to another user"));
        const Caught shared = catch_error([&] { join_and_leave(session, true); });
        CHECK(shared.failure == Failure::protocol_violation);
        CHECK(contains(shared.text, "not open to a group of this process"));
        const Caught created = catch_error([&] { Publisher(session.name(), test_info(), patient()); });
        CHECK(created.failure == Failure::name_in_use);
        CHECK(mode_of(session.path()) == mode);
    }
}

TEST_CASE("a member of the group takes part in a shared segment, but only if it asked for that") {
    if (!is_root("a consumer of another user in the same group")) return;
    const Session session;
    Child producer([&] {
        Publisher publisher(session.name(), shared_info(), patient());
        publisher.wait_for_consumers(1);
        for (std::uint64_t f = 1; f <= 20; ++f) publish_next(publisher, f == 20);
        publisher.close();
        return 0;
    });
    while (mode_of(session.path()) != 0660) usleep(1000);
    CHECK(as_stranger(getegid(), [&] { return join_and_leave(session, false); }) ==
          code_of(Failure::protocol_violation));
    CHECK(as_stranger(strange_group, [&] { return join_and_leave(session, true); }) ==
          code_of(Failure::attach_timeout));  // it may be opened to the group later
    CHECK(as_stranger(getegid(), [&] {
              Subscriber subscriber(session.name(), "crowd", {.waiting = patient(), .group_access = true});
              std::uint64_t seen = 0;
              while (const auto frame = subscriber.acquire()) {
                  seen += is_as_filled(*frame) ? 1U : 0U;
                  subscriber.release();
              }
              return seen == 20 ? 0 : 90;
          }) == 0);
    CHECK(producer.wait() == 0);
}

TEST_CASE("a full /dev/shm is an error at the start, not a crash later, and nothing is left behind") {
    if (!is_root("a /dev/shm of its own")) return;
    const Session session;
    Child child([&] {
        if (unshare(CLONE_NEWNS) != 0 || mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
            mount("tmpfs", "/dev/shm", "tmpfs", 0, "size=256k") != 0)
            return impossible;
        StreamInfo info = test_info();
        Publisher small(session.name() + "-small", info, patient());  // fits
        info.capacity = 100'000;
        try {
            const Publisher publisher(session.name(), info, patient());
            return 90;
        } catch (const std::system_error& error) {
            const bool told = error.code().value() == ENOSPC && contains(error.what(), "df /dev/shm");
            const bool gone = access(session.path().c_str(), F_OK) != 0;
            publish_next(small);  // undisturbed
            return told && gone ? 0 : 91;
        }
    });
    const int code = child.wait();
    if (code == impossible)
        WARN("skipped, this machine allows no /dev/shm of its own");
    else
        CHECK(code == 0);
}

TEST_CASE("a session name with a slash never reaches the file system") {
    const std::string name = "../tmp/evil";
    CHECK_THROWS_WITH(Publisher(name, test_info(), patient()), Catch::Contains("'../tmp/evil' is not allowed"));
    CHECK_THROWS_WITH(Subscriber(name, "crowd", {.waiting = hasty()}), Catch::Contains("'../tmp/evil' is not allowed"));
    CHECK_THROWS_AS(Publisher("a/b", test_info(), patient()), std::invalid_argument);
}
