#include "tools/shm/recording.hpp"

#include <sys/file.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <span>

#include "configs/errors/exit_code.hpp"
#include "shm_protocol/inside/bytes/crc32c.hpp"
#include "shm_protocol/inside/bytes/hash.hpp"
#include "tools/shm/frame_payload.hpp"

namespace wade::recording {
namespace {

constexpr std::uint64_t most_particles = 100'000'000;  // of a frame, the limit of /fluid/max_particles

}  // namespace

// A file that cannot be locked is read all the same.
Recording::Recording(const std::filesystem::path& file) : path_(file), file_(file) {
    if (!file_.is_open())
        throw ConfigurationError("The recording " + file.string() + " cannot be read: " + file_.problem() + ".");
    if (::flock(file_.descriptor(), LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK)
        throw ConfigurationError("The recording " + file.string() + " is being written.");
    file_bytes_ = file_.bytes();
    read_start();
    while (read_record()) {
    }
}

bool Recording::fetch(std::uint64_t from, void* into, std::uint64_t bytes) const {
    return file_.read(from, into, bytes) == bytes;
}

// Reads the body in pieces: a head that claims much takes no memory.
std::uint32_t Recording::crc_of_body(const RecordHead& head) const {
    std::vector<std::byte> piece(std::size_t{1} << 20);
    std::uint32_t crc = 0;
    const std::uint64_t begin = whole_bytes_ + sizeof head;
    for (std::uint64_t done = 0; done < head.body_bytes; done += piece.size()) {
        piece.resize(std::min<std::uint64_t>(piece.size(), head.body_bytes - done));
        if (!fetch(begin + done, piece.data(), piece.size())) refuse_next("it cannot be read");
        crc = shm::crc32c(piece, crc);
    }
    return crc;
}

void Recording::refuse(const std::string& why) const {
    throw ConfigurationError(path_.string() + " " + why + ".");
}

void Recording::refuse_next(const std::string& why) const {
    const std::uint64_t next = frames_.empty() ? 0 : frames_.back().descriptor.frame + 1;
    refuse("is damaged at byte " + std::to_string(whole_bytes_) + ", " +
           (next == 0 ? "its first frame" : "frame " + std::to_string(next)) + ": " + why);
}

void Recording::read_start() {
    struct {
        FileHead head;
        shm::Header page;
    } start;
    static_assert(sizeof start == sizeof(FileHead) + sizeof(shm::Header));
    if (!fetch(0, &start, sizeof start) || start.head.magic != file_magic)
        refuse("is no recording: it does not begin with WADEREC1 and a header page");
    if (start.head.version != whole_version && start.head.version != thinned_version)
        refuse("is a recording of version " + std::to_string(start.head.version) + ", this program reads versions " +
               std::to_string(whole_version) + " and " + std::to_string(thinned_version));
    if (start.head.endian_tag != shm::endian_tag) refuse("was recorded on a machine of another byte order");
    const std::uint32_t crc = start.head.crc32c;
    start.head.crc32c = 0;
    if (shm::crc32c(bytes_of(start)) != crc) refuse("is damaged: the CRC-32C of its header is wrong");
    try {
        map_ = shm::read_header(start.page, start.page.total_bytes);
    } catch (const shm::Error& error) {
        refuse(std::string("holds a header that is refused. ") + error.what());
    }
    if (map_.info.capacity > most_particles)
        refuse("is of a stream of " + std::to_string(map_.info.capacity) +
               " particles; allowed: " + std::to_string(most_particles));
    thinning_ = start.head.thinning;
    if (is_thinned(thinning_) != (start.head.version == thinned_version))
        refuse("is damaged: what its head says of thinning does not fit its version");
    whole_bytes_ = sizeof start;
}

bool Recording::read_record() {
    RecordHead head;
    if (file_bytes_ - whole_bytes_ < sizeof head) return false;
    if (!fetch(whole_bytes_, &head, sizeof head)) refuse_next("it cannot be read");
    if (shm::crc32c(bytes_of(head).first(offsetof(RecordHead, head_crc32c))) != head.head_crc32c)
        refuse_next("the CRC-32C of the head of its record is wrong");
    if (end_) refuse_next("something follows the end record");
    if (head.body_bytes > file_bytes_ - whole_bytes_ - sizeof head) return false;
    const std::uint64_t values = map_.fields.size() * map_.info.capacity;
    if (head.body_bytes > sizeof(shm::SlotDescriptor) + largest_payload(payload_shuffled_zstd, values))
        refuse_next("its record is longer than a frame can be");
    if (crc_of_body(head) != head.body_crc32c) refuse_next("the CRC-32C of its record is wrong");
    if (head.kind == record_frame) {
        keep_frame(head);
    } else if (head.kind == record_end) {
        if (head.body_bytes != sizeof(EndBody)) refuse_next("the end record has a wrong size");
        if (!fetch(whole_bytes_ + sizeof head, &end_.emplace(), sizeof(EndBody))) refuse_next("it cannot be read");
    } else {
        refuse_next("its record is of an unknown kind");
    }
    whole_bytes_ += sizeof head + head.body_bytes;
    return true;
}

void Recording::keep_frame(const RecordHead& head) {
    if (head.body_bytes < sizeof(shm::SlotDescriptor)) refuse_next("its record is too short");
    const PayloadEncoding last = is_quantised(thinning_) ? payload_quantised_zstd : payload_shuffled_zstd;
    if (head.encoding > last) refuse_next("its encoding is unknown");
    FrameRecord record;
    if (!fetch(whole_bytes_ + sizeof head, &record.descriptor, sizeof record.descriptor))
        refuse_next("it cannot be read");
    record.payload_at = whole_bytes_ + sizeof head + sizeof record.descriptor;
    record.payload_bytes = head.body_bytes - sizeof record.descriptor;
    record.encoding = static_cast<PayloadEncoding>(head.encoding);
    const shm::SlotDescriptor& d = record.descriptor;
    if (d.frame == 0) refuse_next("its number is 0");
    if (d.count > map_.info.capacity) refuse_next("it holds more particles than the capacity of the stream");
    if (record.payload_bytes > largest_payload(record.encoding, map_.fields.size() * d.count))
        refuse_next("its payload is longer than its particles can be");
    if (!frames_.empty()) {
        const shm::SlotDescriptor& before = frames_.back().descriptor;
        if (d.frame != before.frame + 1) refuse_next("its number is " + std::to_string(d.frame));
        if (d.tick <= before.tick) refuse_next("its tick does not increase");
        if (d.previous_hash != before.hash) refuse_next("its hash does not continue that of the frame before");
    }
    frames_.push_back(record);
}

std::uint64_t Recording::plain_bytes() const {
    std::uint64_t bytes = 0;
    for (const FrameRecord& record : frames_) bytes += map_.fields.size() * record.descriptor.count * sizeof(float);
    return bytes;
}

void Recording::read(const FrameRecord& record, const shm::FrameFields& slot) {
    const shm::SlotDescriptor& d = record.descriptor;
    const auto damaged = [&](const std::string& why) {
        refuse("is damaged, frame " + std::to_string(d.frame) + ": " + why);
    };
    std::vector<std::byte> payload(record.payload_bytes);
    if (!fetch(record.payload_at, payload.data(), payload.size())) damaged("it cannot be read");
    auto fields = fields_of(slot, map_.info.kind);
    for (auto& field : fields) field = field.first(d.count);
    if (!decode_payload(payload, record.encoding, thinning_, fields))
        damaged("its payload does not hold its particles");
    const std::vector<std::span<const float>> values(fields.begin(), fields.end());
    if (shm::chain_hash(d.previous_hash, d.frame, values) != d.hash) damaged("its particles do not match its hash");
}

}  // namespace wade::recording
