#include "shm_protocol/inside/attach.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <system_error>

#include "shm_protocol/inside/atomic.hpp"
#include "shm_protocol/inside/futex.hpp"
#include "shm_protocol/inside/liveness.hpp"
#include "shm_protocol/inside/wait.hpp"

namespace wade::shm {
namespace {

constexpr std::int64_t retry_ns = 5'000'000;  // an absent segment has no word to sleep on

std::string hexadecimal(std::uint64_t value) {
    char text[32];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
    return text;
}

// What one look at the name found: a producer to join, or the reason to look again later.
struct Found {
    std::optional<Link> link;
    std::string otherwise;
};

bool has_ended(std::uint32_t producer_state) {
    return producer_state >= producer_draining;
}

void map_entry(Link& link, const AttachRequest& request) {
    if (request.shared_base != nullptr) {
        link.entry = &Pages<std::byte>(request.shared_base, *link.map).consumer(link.index);
        return;
    }
    const std::uint64_t at = link.map->consumers + link.index * link.map->consumer_stride;
    link.entry_page = link.file.map(at, sizeof(ConsumerEntry), true);
    link.entry = static_cast<ConsumerEntry*>(link.entry_page.get_address());
}

// Returns whether entry i may be taken: it is unused, or the producer has seen its last owner's goodbye. A producer
// that read the entry just before the goodbye may still admit that owner a moment after it. Once another frame was
// published, that survey is over; so published_frame is read before admitted_frame.
bool is_free(const Link& link, std::uint32_t i) {
    const ConsumerEntry& entry = link.pages.consumer(i);
    const Control& control = link.pages.control();
    const std::uint32_t state = load_acquire(entry.state);
    if (state == consumer_joined) return false;
    const bool rested =
        state == consumer_free || load_acquire(control.published_frame) > load_acquire(entry.left_at_frame);
    return rested && load_acquire(control.admitted_frame[i]) == 0;
}

// Returns whether a free-running reader holds the entry. The producer does not notice such a reader's death; the next
// consumer that can lock the entry writes the goodbye.
bool is_deserted(const ConsumerEntry& entry) {
    return load_acquire(entry.state) == consumer_joined && load_relaxed(entry.mode) == mode_latest;
}

// Takes the first free entry. The lock is taken before the last check, so two consumers cannot both succeed.
bool claim_entry(Link& link, const AttachRequest& request) {
    for (std::uint32_t i = 0; i < link.map->consumer_count; ++i) {
        const ConsumerEntry& entry = link.pages.consumer(i);
        if ((!is_free(link, i) && !is_deserted(entry)) || !lock_byte(link.file.fd(), consumer_lock_byte + i)) continue;
        link.index = i;
        if (is_deserted(entry)) {
            map_entry(link, request);
            store_release(link.entry->state, static_cast<std::uint32_t>(consumer_left));
            link.ring();
            link.lay_to_rest();
        } else if (is_free(link, i)) {
            map_entry(link, request);
            return true;
        }
        unlock_byte(link.file.fd(), consumer_lock_byte + i);
    }
    return false;
}

void fill_entry(Link& link, const AttachRequest& request, ConsumerState state, const Refusal& refusal) {
    ConsumerEntry& entry = *link.entry;
    link.mode = request.mode;
    link.flags = request.options.follows ? std::uint32_t{consumer_follows} : 0U;
    store_release(entry.acknowledged_frame, std::uint64_t{0});
    store_release(entry.waiting, 0U);
    store_relaxed(entry.heartbeat_ns, static_cast<std::uint64_t>(monotonic_ns()));
    store_relaxed(entry.mode, static_cast<std::uint32_t>(link.mode));
    store_relaxed(entry.flags, link.flags);
    store_relaxed(entry.paused, 0U);
    store_relaxed(entry.left_at_frame, state == consumer_joined ? ~std::uint64_t{0} : 0);
    entry.stride = request.stride;
    store_relaxed(entry.dropped_frames, std::uint64_t{0});
    entry.start_time = process_start_time();
    entry.pid = static_cast<std::uint32_t>(getpid());
    store_text(entry.name, name_bytes, request.consumer_name);
    entry.reason_code = refusal.reason_code;
    store_text(entry.reason_text, reason_bytes, refusal.text);
    store_release(entry.state, static_cast<std::uint32_t>(state));
    link.ring();
}

void map_pages(Link& link, const AttachRequest& request) {
    const SegmentMap& map = *link.map;
    if (request.shared_base != nullptr) {
        link.pages = Pages<const std::byte>(request.shared_base, map);
        link.doorbell = &Pages<std::byte>(request.shared_base, map).doorbell();
        return;
    }
    link.all = link.file.map(0, map.total_bytes, false);
    link.pages = Pages<const std::byte>(static_cast<const std::byte*>(link.all.get_address()), map);
    link.doorbell_page = link.file.map(map.doorbell, sizeof(Doorbell), true);
    link.doorbell = static_cast<Doorbell*>(link.doorbell_page.get_address());
}

// The object of that name if this consumer may trust it; without one, why there is none yet.
struct Opened {
    std::optional<SegmentFile> file;
    std::string otherwise;
};

// Errors: protocol_violation for what is no plain file, and for another user's object, unless the caller accepts one that
// is open to its group.
Opened open_trusted(const std::string& name, bool group_access) {
    const std::string foreign = "shared-memory segment " + name + " belongs to another user" +
                                (group_access ? " and is not open to a group of this process" : "");
    const Error refused(Failure::protocol_violation, "The " + foreign + ".");
    std::optional<SegmentFile> file;
    try {
        file = SegmentFile::open(name);
    } catch (const ForeignObject& what) {
        throw Error(Failure::protocol_violation, std::string(what.what()) + ".");
    } catch (const std::system_error& e) {
        if (e.code().value() != EACCES) throw;
        // A new segment is its owner's alone until its producer opens it to the group.
        if (group_access) return {std::nullopt, "the " + foreign};
        throw refused;
    }
    if (!file) return {std::nullopt, "there is no shared-memory segment " + name};
    if (file->owned_by_this_user() || (group_access && file->open_to_group_of_this_process()))
        return {std::move(file), ""};
    if (group_access && file->size() == 0) return {std::nullopt, "the " + foreign};
    throw refused;
}

// A private copy of the header page once the magic is stored, empty before.
std::optional<Header> copy_header(const SegmentFile& file) {
    const auto page = file.map(0, page_bytes, false);
    const auto* const shared = static_cast<const Header*>(page.get_address());
    if (load_acquire(shared->magic) == 0) return std::nullopt;
    Header copy;
    std::memcpy(&copy, shared, sizeof copy);
    return copy;
}

Found look(const std::string& name, const AttachRequest& request) {
    Opened opened = open_trusted(name, request.options.group_access);
    if (!opened.file) return {std::nullopt, opened.otherwise};
    const std::optional<SegmentFile>& file = opened.file;
    if (!is_locked_by_other(file->fd(), producer_lock_byte))
        return {std::nullopt, "the shared-memory segment " + name + " was left by a producer that is dead"};
    const std::uint64_t size = file->size();
    if (size == 0) return {std::nullopt, "the producer of " + name + " has not sized its segment yet"};
    if (size < page_bytes)
        throw Error(Failure::protocol_violation, "The shared-memory segment " + name + " is cut off: it holds " +
                                                     std::to_string(size) + " bytes, its header alone 4096.");
    const std::optional<Header> header = copy_header(*file);
    if (!header) return {std::nullopt, "the producer of " + name + " has not finished its header yet"};

    Link link;
    try {
        link.map = std::make_unique<SegmentMap>(read_header(*header, size));
    } catch (const Error& error) {
        throw Error(error.failure(), "The shared-memory segment " + name + " is refused. " + error.what());
    }
    if (link.map->info.kind != request.options.kind)
        throw Error(Failure::protocol_violation, "The shared-memory segment " + name + " holds a stream of kind " +
                                                     std::to_string(link.map->info.kind) + ", its name stands for " +
                                                     std::to_string(request.options.kind) + ".");
    link.file = std::move(*opened.file);
    map_pages(link, request);
    if (has_ended(load_acquire(link.pages.control().state)))
        return {std::nullopt, "the producer of " + name + " has ended its stream"};
    link.producer_pid = link.pages.control().pid;
    if (!claim_entry(link, request)) return {std::nullopt, "all consumer entries of " + name + " are taken"};

    const std::uint64_t theirs = link.map->info.scene_hash;
    const std::uint64_t ours = request.options.scene_hash;
    if (ours != 0 && theirs != 0 && theirs != ours) {
        const std::string reason = "The two programs were given different scenes: producer '" +
                                   link.map->info.producer_name + "' has scene " + hexadecimal(theirs) +
                                   ", consumer '" + request.consumer_name + "' has scene " + hexadecimal(ours) + ".";
        fill_entry(link, request, consumer_refused, {static_cast<int>(Failure::protocol_violation), reason});
        throw Error(Failure::protocol_violation, reason);
    }
    fill_entry(link, request, request.refusal ? consumer_refused : consumer_joined,
               request.refusal.value_or(Refusal{}));
    return {std::move(link), ""};
}

}  // namespace

Link attach(const AttachRequest& request) {
    const Waiting& waiting = request.options.waiting;
    const std::string name = segment_name(request.session, request.options.kind);
    if (request.consumer_name.empty() || request.consumer_name.size() >= name_bytes)
        throw std::invalid_argument("Consumer name '" + request.consumer_name + "' is not allowed: 1 to 63 bytes are.");
    check_waiting(waiting);
    Patience patience(waiting.attach_timeout_s);
    std::int64_t last = monotonic_ns();
    for (;;) {
        Found found = look(name, request);
        if (found.link) return std::move(*found.link);
        if (patience.exhausted()) {
            char seconds[32];
            std::snprintf(seconds, sizeof seconds, "%g", waiting.attach_timeout_s);
            throw Error(Failure::attach_timeout, std::string("Waited ") + seconds +
                                                     " s in vain for a producer of session '" + request.session +
                                                     "': " + found.otherwise + ".");
        }
        check_interrupted(waiting, "a producer of session '" + request.session + "'");
        const timespec pause{0, retry_ns};
        nanosleep(&pause, nullptr);
        const std::int64_t now = monotonic_ns();
        patience.count(1e-9 * static_cast<double>(now - last));
        last = now;
    }
}

}  // namespace wade::shm
