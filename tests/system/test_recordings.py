"""shm_record writes a run into a file, shm_replay plays it: the crowd cannot tell the two apart."""

import re
import signal
import struct
import subprocess
import unittest

import numpy as np
import recording_file
from harness import ENDLESS, PROGRAMS, Run, SystemTest, wait_until

from wade.export.recording import Recording, chain

RECORD, REPLAY = PROGRAMS / "shm_record", PROGRAMS / "shm_replay"
SHORT = ["--until-s", "1"]  # 30 frames


class RecordingTest(SystemTest):
    def setUp(self):
        super().setUp()
        self.file = self.folder / "run.wrec"

    def recorder(self, *arguments):
        return self.start(RECORD, self.session, self.file, *arguments)

    def replay(self, *arguments):
        return self.start(REPLAY, self.file, "--session", self.session, *arguments)

    def info(self):
        answer = subprocess.run([REPLAY, "--info", self.file], capture_output=True, text=True, check=False)
        self.assertEqual(answer.returncode, 0, answer.stderr)
        return answer.stdout

    def recorded_frames(self):
        found = re.search(r"^frames +1 to (\d+)", self.info(), re.MULTILINE)
        return int(found[1]) if found else 0

    def recorded_run(self, *arguments, recorder=()):
        """Records a whole run and returns it."""
        server = self.server("--consumers", "2", *arguments)
        recorder = self.recorder(*recorder)
        client = self.client("--reproducible", *arguments)
        self.assert_ended_well(server, recorder, client)
        return client.run

    def replayed_run(self, *arguments, client=()):
        replay, crowd = self.replay(*arguments), self.client("--reproducible", *client)
        self.assert_ended_well(replay, crowd)
        return crowd.run

    def assert_same_folders(self, one, other):
        self.assertIsNotNone(one.outcome()["frame_hash"])
        names = sorted(path.name for path in one.folder.iterdir())
        self.assertEqual(names, sorted(path.name for path in other.folder.iterdir()))
        for name in names:
            self.assertEqual(one.bytes_of(name), other.bytes_of(name), name)


class RoundTrip(RecordingTest):
    def test_replay_gives_the_folder_of_the_live_run_file_by_file(self):
        live = self.recorded_run()
        self.assertGreater(live.outcome()["arrived"], 0)
        self.assert_same_folders(live, self.replayed_run())

    def test_recorded_run_is_the_run_without_a_recorder(self):
        self.assert_same_folders(self.pair("--reproducible", *SHORT), self.recorded_run(*SHORT))

    def test_an_older_recording_stays_until_a_frame_comes(self):
        self.recorded_run(*SHORT)
        older = self.file.read_bytes()
        server, recorder = self.server("--consumers", "2"), self.recorder()
        wait_until(lambda: "recording session" in recorder.messages() or not recorder.running(), "the recorder")
        recorder.send(signal.SIGINT)
        self.assert_ends(recorder, 130, "no frame came", "still the recording that was there")
        self.assertEqual(self.file.read_bytes(), older)
        server.send(signal.SIGTERM)
        server.wait()

    def test_a_recorder_that_meets_nobody_leaves_no_file(self):
        self.assert_ends(self.recorder("--attach-timeout-s", "0.2"), 3)
        self.assertFalse(self.file.exists())

    def test_replay_at_any_depth_gives_the_same_folder(self):
        live = self.recorded_run(*SHORT)
        for depth in ("1", "3"):
            with self.subTest(depth=depth):
                self.assert_same_folders(live, self.replayed_run("--depth", depth, client=SHORT))

    def test_compression_changes_the_size_and_nothing_else(self):
        sizes = []
        for level in ("0", "1", "19"):
            live = self.recorded_run(*SHORT, recorder=("--compression", level))
            self.assert_same_folders(live, self.replayed_run(client=SHORT))
            sizes.append(self.file.stat().st_size)
        self.assertGreater(sizes[0], sizes[1])
        self.assertGreater(sizes[1], sizes[2])

    def test_replay_can_be_recorded_and_the_copy_is_the_same_file(self):
        self.recorded_run(*SHORT)
        first = self.file.read_bytes()
        original = self.file.rename(self.folder / "original.wrec")
        replay = self.start(REPLAY, original, "--session", self.session, "--consumers", "2")
        recorder, client = self.recorder(), self.client(*SHORT)
        self.assert_ended_well(replay, recorder, client)
        self.assertEqual(self.session_id_left_out(first), self.session_id_left_out(self.file.read_bytes()))

    def session_id_left_out(self, data):
        """What a recording holds but for the session's random number and the checksums over it."""
        page = recording_file.HEAD_BYTES
        return data[: page - 48] + data[page : page + 24] + data[page + 28 : page + 40] + data[page + 48 :]

    def test_run_at_a_pace_that_cannot_be_repeated_is_repeated_from_its_recording(self):
        server = self.server("--consumers", "2", "--clock", "variable", *SHORT)
        recorder, client = self.recorder(), self.client("--reproducible", *SHORT)
        self.assert_ended_well(server, recorder, client)
        self.assert_same_folders(client.run, self.replayed_run(client=SHORT))

    def test_other_scene_is_refused_unless_any_is_allowed(self):
        self.recorded_run(*SHORT)
        other = ["--until-s", "1", "--set", "/crowd/tau=0.3"]
        replay, client = self.replay(), self.client(*other)
        self.assert_ends(client, 6, "different scenes")
        self.assert_ends(replay, 5, "refused")
        replay, client = self.replay("--any-scene"), self.client(*other)
        self.assert_ended_well(replay, client)
        self.assertEqual(client.run.outcome()["frames"], 30)

    def test_stream_that_the_crowd_left_early_is_recorded_and_replayed(self):
        endless = ["--until-s", "5000"]  # ends when all have arrived
        live = self.recorded_run(*endless)
        self.assertEqual(live.outcome()["arrived"], 6)
        self.assertIn("complete: the stream ended", self.info())
        self.assert_same_folders(live, self.replayed_run(client=endless))


class Format(RecordingTest):
    def test_file_is_what_the_readme_says(self):
        """Reads a stored recording with a reader of its own and follows the hash chain."""
        live = self.recorded_run(*SHORT, recorder=("--compression", "0"))
        data = self.file.read_bytes()
        self.assertEqual(data[:8], b"WADEREC1")
        page_at = recording_file.HEAD_BYTES
        self.assertEqual(data[page_at : page_at + 8], b"WADESHM1")
        start = data[:16] + bytes(4) + data[20 : page_at + recording_file.PAGE_BYTES]
        self.assertEqual(struct.unpack_from("<I", data, 16)[0], recording_file.crc32c(start))
        *frames, end = recording_file.records(data)
        self.assertEqual((len(frames), end.kind), (30, recording_file.END))
        previous = 0
        for number, record in enumerate(frames, 1):
            self.assertEqual((record.kind, record.encoding), (recording_file.FRAME, 0))
            self.assertEqual(record.body_crc, recording_file.crc32c(data[record.body_at : record.end]))
            self.assertEqual(record.head_crc, recording_file.crc32c(data[record.at : record.at + 20]))
            _sequence, frame, _tick, count, _flags, own, before = record.descriptor(data)
            self.assertEqual((frame, before), (number, previous))
            fields = np.frombuffer(record.payload(data), dtype=np.uint32).reshape(7, count)
            previous = chain(previous, frame, fields)
            self.assertEqual(own, previous, f"hash of frame {frame}")
        self.assertEqual(f"{previous:016x}", live.outcome()["frame_hash"])
        self.assertEqual(struct.unpack_from("<QQIi", data, end.body_at), (30, previous, 0, 0))

    def test_info_tells_frames_particles_and_hash(self):
        live = self.recorded_run(*SHORT)
        info = self.info()
        for text in ("water of 'dfsph'", "frames      1 to 30, up to 1 s, the last one final; 640 to 640 particles"):
            self.assertIn(text, info)
        self.assertIn(f"frame hash  {live.outcome()['frame_hash']}", info)


class Thinned(RecordingTest):
    """Recordings of version 2, beside the whole one of the same run."""

    BOX = ("--region", "2,15,0,2,4.5,7.5")

    def thinned(self, *arguments):
        """Returns the frames of a whole recording, [(tick, mass, velocities and positions)], and the thinned one."""
        whole = self.folder / "whole.wrec"
        server = self.server("--consumers", "3", *SHORT)
        recorders = self.start(RECORD, self.session, whole, "--compression", "0"), self.recorder(*arguments)
        client = self.client(*SHORT)
        self.assert_ended_well(server, client, *recorders)
        data = whole.read_bytes()
        self.assertEqual(data[8:12] + data[20:64], b"\1\0\0\0" + bytes(44))  # version 1, as it always was
        frames = []
        for record in recording_file.records(data)[:-1]:
            _, _, tick, count, *_ = record.descriptor(data)
            frames.append((tick, np.frombuffer(record.payload(data), "<f4").reshape(7, count)))
        read = Recording(self.file)
        self.addCleanup(read.file.close)
        return frames, read, [(frame.time_s, np.array(list(frame.values().values()))) for frame in read.frames()]

    def inside(self, fields):
        x, y, z = fields[4:]
        return fields[:, (x >= 2) & (x <= 15) & (y >= 0) & (y <= 2) & (z >= 4.5) & (z <= 7.5)]

    def test_interval_keeps_whole_frames_at_its_multiples_and_both_ends(self):
        frames, read, kept = self.thinned("--interval-s", "0.13")  # 3.9 frames
        self.assertAlmostEqual(read.rate_hz, 1 / 0.13)
        due = [1, 4, 8, 12, 16, 20, 24, 28, 30]
        self.assertEqual([round(30 * time_s) for time_s, _ in kept], due)
        for tick, (_, fields) in zip(due, kept):
            self.assertTrue(np.array_equal(fields, frames[tick - 1][1]))
        self.assertIn("thinned     a frame each 0.13 s\n", self.info())

    def test_region_keeps_what_lies_in_it_bit_by_bit(self):
        frames, _, kept = self.thinned(*self.BOX)
        self.assertEqual(len(kept), 30)
        for (_, whole), (_, fields) in zip(frames, kept):
            self.assertTrue(np.array_equal(self.inside(whole), fields))
        self.assertGreater(len(kept[0][1][0]), 100)

    def test_rounded_values_are_as_near_as_the_head_says(self):
        frames, read, kept = self.thinned(*self.BOX, "--quantised")
        # Half of 13 m / 65535, and less than a millionth of a metre by float32.
        self.assertLess(abs(read.position_error_m - 0.5 * 13 / 65535), 2e-6)
        self.assertEqual(read.velocity_step, 1 / 512)
        worst = 0
        for (_, whole), (_, fields) in zip(frames, kept):
            off = np.abs(fields - self.inside(whole))
            self.assertEqual(off[0].max(), 0)
            self.assertLessEqual(off[1:4].max(), 0.5 / 512)
            worst = max(worst, off[4:].max())
        self.assertLessEqual(worst, read.position_error_m)
        self.assertGreater(worst, 0.9 * read.position_error_m)  # the bound is no wider than need be

    def test_a_thinned_recording_can_be_played_and_says_what_it_is_not(self):
        live = self.recorded_run(*SHORT, recorder=(*self.BOX, "--quantised", "--interval-s", "0.2"))
        replay, crowd = self.replay(), self.client("--reproducible", *SHORT)
        self.assert_ended_well(replay, crowd)
        self.assertIn("is thinned (a frame each 0.2 s; x 2 to 15", replay.messages())
        outcome = crowd.run.outcome()
        self.assertEqual((outcome["fluid"]["model"], outcome["steps"]), ("dfsph, thinned", 30))
        self.assertNotEqual(outcome["frame_hash"], live.outcome()["frame_hash"])
        self.assertIn(f"frame hash  {outcome['frame_hash']}", self.info())

    def test_what_cannot_be_thinned_is_refused(self):
        for arguments, text in ((["--quantised"], "--quantised needs --region"),
                                (["--region", "1,2,3"], "--region: 1,2,3 is not allowed"),
                                (["--region", "1,2,4,3"], "allowed: X0,X1,Z0,Z1"),
                                (["--interval-s=-1"], "--interval-s")):
            self.assert_ends(self.recorder(*arguments), 2, text)
        server = self.server(*WayBack.TWO_WAY)
        recorder = self.recorder("--stream", "agents", "--lead", *self.BOX)
        self.client(*WayBack.TWO_WAY, "--agents-consumers", "2")
        self.assert_ends(recorder, 2, "are for water in metres")
        server.wait()


class DamagedFiles(RecordingTest):
    def setUp(self):
        super().setUp()
        self.recorded_run(*SHORT)
        self.whole = self.file.read_bytes()
        self.records = recording_file.records(self.whole)

    def assert_refused(self, data, *texts):
        self.file.write_bytes(data)
        self.assert_ends(self.replay(), 2, str(self.file), *texts)
        self.assert_ends(self.start(REPLAY, "--info", self.file), 2, *texts)

    def spoilt(self, at):
        data = bytearray(self.whole)
        data[at] ^= 0x10
        return bytes(data)

    def test_file_that_was_cut_off_plays_to_the_last_whole_record_and_says_so(self):
        seventh = self.records[6]
        # In the middle of its head, of its payload, before its last byte, and between two records.
        for cut in (seventh.at + 5, seventh.body_at + 300, seventh.end - 1, seventh.at):
            with self.subTest(cut=cut):
                self.file.write_bytes(self.whole[:cut])
                self.assertIn("cut off after frame 6", self.info())
                replay, client = self.replay(), self.client(*SHORT)
                self.assert_ended_well(replay, client)
                self.assertIn("cut off after frame 6", replay.messages())
                outcome = client.run.outcome()
                self.assertEqual((outcome["status"], outcome["frames"]), ("stream_ended", 6))
                self.assertIn("ended after frame 6", outcome["message"])
                self.assertIn(outcome["message"], client.messages())

    def test_many_crowds_say_so_too_when_the_file_was_cut_off(self):
        self.file.write_bytes(self.whole[: self.records[6].at])
        crowds = self.folder / "crowds.json"
        crowds.write_text('[{"name": "a"}, {"name": "b", "set": {"/seed": 2}}]')
        replay, client = self.replay(), self.client(*SHORT, "--crowds", crowds, out=self.folder / "many")
        self.assert_ended_well(replay, client)
        outcome = Run(self.folder / "many" / "b").outcome()
        self.assertEqual((outcome["status"], outcome["frames"]), ("stream_ended", 6))
        self.assertIn("ended after frame 6", outcome["message"])
        self.assertIn(outcome["message"] + "; crowds that it ended: 2", client.messages())
        self.assertIn("b,2,stream_ended,6,0,0,6,0,0,0,,", (self.folder / "many" / "crowds.csv").read_text())

    def test_file_without_its_end_record_plays_whole(self):
        self.file.write_bytes(self.whole[: self.records[-1].at])
        replay, client = self.replay(), self.client(*SHORT)
        self.assert_ended_well(replay, client)
        self.assertEqual(client.run.outcome()["frames"], 30)
        self.assertIn("cut off after frame 30", replay.messages())

    def test_damaged_record_is_refused_with_the_number_of_its_frame(self):
        seventh = self.records[6]
        for at in (seventh.at + 1, seventh.at + 12, seventh.at + 17, seventh.body_at + 16, seventh.end - 1):
            with self.subTest(at=at):
                self.assert_refused(self.spoilt(at), "damaged", "frame 7")

    def test_damaged_header_is_refused(self):
        self.assert_refused(self.spoilt(recording_file.HEAD_BYTES + 64), "header")
        self.assert_refused(self.spoilt(0), "no recording")
        self.assert_refused(self.whole[:100], "no recording")
        self.assert_refused(b"", "no recording")

    def test_missing_frame_is_refused(self):
        seventh = self.records[6]
        self.assert_refused(self.whole[: seventh.at] + self.whole[seventh.end :], "frame 7")

    def test_forged_frame_does_not_match_its_hash(self):
        """All checksums are right, one value is another one."""
        live = self.recorded_run(*SHORT, recorder=("--compression", "0"))
        data = bytearray(self.file.read_bytes())
        seventh = recording_file.records(data)[6]
        data[seventh.body_at + recording_file.DESCRIPTOR_BYTES + 3 * 640 * 4] ^= 1
        self.file.write_bytes(recording_file.with_right_checksums(data, seventh))
        replay, client = self.replay(), self.client(*SHORT)
        self.assert_ends(replay, 2, "frame 7", "hash")
        self.assert_ends(client, 5, "frame 7")
        self.assertEqual(client.run.outcome()["frames"], 6)
        self.assertEqual(live.outcome()["frames"], 30)


class WayBack(RecordingTest):
    """Two-way runs: the crowd sends its agents back, and a consumer must take them."""

    TWO_WAY = [*SHORT, "--set", "/coupling/agents_stream=serial"]

    def test_replay_takes_the_agents_that_the_server_took(self):
        live = self.recorded_run(*self.TWO_WAY)
        self.assertIsNotNone(live.outcome()["agents_hash"])
        self.assert_same_folders(live, self.replayed_run("--take-agents", client=self.TWO_WAY))

    def test_agents_of_a_live_run_are_recorded_from_frame_1(self):
        live = self.pair(*self.TWO_WAY)
        server = self.server(*self.TWO_WAY)
        recorder = self.recorder("--stream", "agents", "--lead")
        crowd = self.client(*self.TWO_WAY, "--agents-consumers", "2")
        self.assert_ended_well(server, crowd, recorder)
        for text in ("agents of 'crowd", f"frame hash  {live.outcome()['agents_hash']}", "complete"):
            self.assertIn(text, self.info())

    def test_agents_can_be_recorded_beside_a_replay_and_played_in_turn(self):
        self.recorded_run(*self.TWO_WAY)
        agents, again = self.folder / "agents.wrec", self.folder / "again.wrec"
        replay, crowd = self.replay(), self.client(*self.TWO_WAY)
        recorder = self.start(RECORD, self.session, agents, "--stream", "agents", "--lead")
        self.assert_ended_well(replay, crowd, recorder)
        crowd_hash = crowd.run.outcome()["agents_hash"]
        for file in (agents, again):
            info = subprocess.run([REPLAY, "--info", file], capture_output=True, text=True, check=False).stdout
            for text in ("agents of 'crowd", "6 to 6 particles", f"frame hash  {crowd_hash}", "complete"):
                self.assertIn(text, info)
            if file == agents:
                producer = self.start(REPLAY, agents, "--session", self.session)
                recorder = self.start(RECORD, self.session, again, "--stream", "agents", "--lead")
                self.assert_ended_well(producer, recorder)


class Ends(RecordingTest):
    def running(self):
        """An endless run with a recorder, some frames old."""
        server = self.server("--consumers", "2", *ENDLESS)
        recorder, client = self.recorder(), self.client(*ENDLESS)
        self.wait_for_frame(10, server, recorder, client)
        return server, recorder, client

    def test_killed_recorder_is_a_dead_peer_and_its_file_holds_all_it_acknowledged(self):
        server, recorder, client = self.running()
        recorder.send(signal.SIGKILL)
        self.assert_ends(server, 4, "Consumer 'recorder'", "died at frame")
        self.assert_ends(client, 5, "recorder")
        died_at = int(re.search(r"died at frame (\d+)", server.messages())[1])
        self.assertGreaterEqual(self.recorded_frames(), died_at - 1)
        self.assertIn("cut off after frame", self.info())

    def test_recorder_leaves_at_a_signal_and_the_run_goes_on(self):
        for number, code in ((signal.SIGTERM, 143), (signal.SIGINT, 130)):
            with self.subTest(signal=number.name):
                server, recorder, client = self.running()
                recorder.send(number)
                self.assert_ends(recorder, code, "left at a signal")
                frame = self.published_frame()
                self.assertIn("the recorder ended after frame", self.info())
                self.assertGreaterEqual(frame, self.recorded_frames())
                self.wait_for_frame(frame + 10, server, client)
                client.send(signal.SIGTERM)
                self.assert_ends(client, 143)
                self.assert_ends(server, 5)

    def test_recorder_leaves_at_a_signal_while_nothing_happens(self):
        server = self.server("--consumers", "3", *SHORT)
        recorder = self.recorder()
        wait_until(lambda: "recording session" in recorder.messages(), "the recorder to join")
        recorder.send(signal.SIGTERM)
        self.assert_ends(recorder, 143)
        self.assertIn("frames      none", self.info())
        self.assertTrue(server.running(), "the goodbye was a clean one")
        server.send(signal.SIGTERM)
        self.assert_ends(server, 143)

    def test_recorder_leaves_after_the_frames_it_was_asked_for(self):
        server = self.server("--consumers", "2", *SHORT)
        recorder, client = self.recorder("--frames", "7"), self.client(*SHORT)
        self.assert_ended_well(server, recorder, client)
        self.assertEqual(client.run.outcome()["frames"], 30)
        self.assertEqual(self.recorded_frames(), 7)

    def test_killed_server_leaves_a_recording_of_all_frames_it_sent(self):
        server, recorder, client = self.running()
        self.kill_server(server)
        self.assert_ends(recorder, 4, "died at frame")
        self.assert_ends(client, 4)
        last = int(re.search(r"the last complete frame is (\d+)", recorder.messages())[1])
        self.assertEqual(self.recorded_frames(), last)
        self.assertIn("died at frame", self.info())
        self.remove_segment_of_killed_server()

    def test_file_that_is_no_recording_is_not_overwritten(self):
        self.file.write_text("my only copy of something else\n")
        self.assert_ends(self.recorder(), 2, str(self.file), "no recording")
        self.assertEqual(self.file.read_text(), "my only copy of something else\n")

    def test_recorder_without_a_session_is_an_attach_timeout(self):
        self.assert_ends(self.recorder("--attach-timeout-s", "0.1"), 3, self.session)

    def test_replay_of_a_session_in_use_is_refused(self):
        self.recorded_run(*SHORT)
        server = self.server(*ENDLESS)
        self.wait_for_segment()
        self.assert_ends(self.replay(), 8, "in use")
        server.send(signal.SIGTERM)
        self.assert_ends(server, 143)

    def test_replay_without_a_consumer_is_an_attach_timeout(self):
        self.recorded_run(*SHORT)
        self.assert_ends(self.replay("--attach-timeout-s", "0.1"), 3, "1 consumer to join")

    def test_interrupted_replay_tells_the_crowd_why(self):
        self.recorded_run(*SHORT)
        replay = self.replay("--consumers", "2")
        client = self.client(*SHORT)
        self.wait_for_segment()
        replay.send(signal.SIGTERM)
        self.assert_ends(replay, 143, "nterrupted")
        self.assertIn(client.wait(), (3, 5))


if __name__ == "__main__":
    unittest.main()
