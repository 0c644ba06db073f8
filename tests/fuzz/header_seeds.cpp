// Writes headers as make_header fills them into a folder, the first corpus of fuzz_header.

#include <cstdio>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include "tests/fuzz/header_input.hpp"

using wade::shm::StreamInfo;

namespace {

void write(const std::string& folder, const std::string& name, std::uint8_t repairs, const wade::shm::Header& header) {
    const auto bytes = wade::fuzz::write_input(repairs, header);
    std::ofstream file(folder + "/" + name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!file) throw std::runtime_error("cannot write " + folder + "/" + name);
}

void write(const std::string& folder, const std::string& name, std::uint8_t repairs, const StreamInfo& info) {
    write(folder, name, repairs, wade::shm::make_header(info, 1));
}

}  // namespace

int main(int argc, char** argv) try {
    if (argc != 2) {
        std::cerr << "Usage: header_seeds FOLDER\n";
        return 2;
    }
    constexpr std::uint8_t all = wade::fuzz::repair_identity | wade::fuzz::repair_crc | wade::fuzz::repair_size;
    StreamInfo info;
    info.producer_name = "seed";
    info.capacity = 20;
    write(argv[1], "fluid", all, info);
    write(argv[1], "fluid_nothing_repaired", wade::fuzz::repair_size, info);
    // Room for a change of one member to stay without consequences for the others.
    wade::shm::Header roomy = wade::shm::make_header(info, 1);
    roomy.slot_stride *= 64;
    roomy.slots_offset <<= 20;
    roomy.total_bytes = std::uint64_t{1} << 62;
    write(argv[1], "fluid_roomy", all, roomy);
    info.depth = 3;
    info.slots = 64;
    write(argv[1], "fluid_64_slots", all, info);
    info.capacity = 0xFFFFFFFFU;
    write(argv[1], "fluid_largest", all, info);
    info = {};
    info.producer_name = "seed";
    info.kind = wade::shm::stream_agents;
    info.capacity = 1;
    info.coupling_lag = 1;
    info.metres_per_unit = 10;
    info.origin = {1, 2, 3};
    info.axes = {1, 3, -2};
    write(argv[1], "agents", all, info);
    return 0;
} catch (const std::exception& error) {
    std::cerr << "header_seeds: " << error.what() << '\n';
    return 1;
}
