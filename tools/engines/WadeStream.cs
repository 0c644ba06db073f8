// The newest frame of a Wade session, for Unity and any other program in C#, through the C ABI (libwade_shm.so, Linux).
//
//     using (var water = new Wade.Stream("demo"))
//         while (water.Poll() != Wade.News.End)     // once a picture; never waits
//             Draw(water.X, water.Y, water.Z, water.Count);
//
// A free-running reader: it holds up nobody and may miss frames. Places and velocities are in metres, x upstream, y up,
// z across: left-handed, as Unity's axes, so that new Vector3(X[i], Y[i], Z[i]) is the place (docs/engines.md).
// For a project of Unity: this file into Assets, libwade_shm.so into Assets/Plugins.
using System;
using System.Runtime.InteropServices;

namespace Wade
{
    public enum News { Nothing, Frame, End }

    /// <summary>What the session or the library says is wrong; Code is an exit code of docs/protocol.md.</summary>
    public sealed class StreamException : Exception
    {
        public readonly int Code;
        public StreamException(int code, string text) : base(text) { Code = code; }
    }

    public sealed class Stream : IDisposable
    {
        const int Ok = 0, AtEnd = -1, NothingNew = -2, AbiVersion = 1;

        [StructLayout(LayoutKind.Sequential)]
        struct Join // wade_join
        {
            public ulong SceneHash;
            public uint Kind, Follows, GroupAccess, Reserved;
            public double AttachTimeout, StepWarning, StepTimeout;
            public IntPtr Interrupted, Warn, Context;
        }

        [StructLayout(LayoutKind.Explicit, Size = 184)]
        struct Info // wade_stream, as far as it is read here
        {
            [FieldOffset(80)] public ulong TicksPerSecond;
            [FieldOffset(96)] public double Metres;
            [FieldOffset(104)] public double OriginX;
            [FieldOffset(112)] public double OriginY;
            [FieldOffset(120)] public double OriginZ;
            [FieldOffset(128)] public int AxisX;
            [FieldOffset(132)] public int AxisY;
            [FieldOffset(136)] public int AxisZ;
            [FieldOffset(144)] public double ParticleRadius;
        }

        [StructLayout(LayoutKind.Sequential, Size = 304)]
        struct Frame // wade_frame, without its diagnostics
        {
            public ulong Number, Tick, Hash;
            public uint Count, Final;
            public IntPtr Mass, Vx, Vy, Vz, Px, Py, Pz, Radius, Height, State;
        }

        const string Library = "wade_shm";
        [DllImport(Library)] static extern uint wade_abi_version();
        [DllImport(Library)] static extern IntPtr wade_last_error();
        [DllImport(Library)] static extern void wade_join_defaults(out Join join);
        [DllImport(Library)] static extern int wade_latest_open(string session, string name, ref Join join, uint stride,
                                                                out IntPtr reader);
        [DllImport(Library)] static extern int wade_latest_stream(IntPtr reader, out Info info);
        [DllImport(Library)] static extern int wade_latest_poll(IntPtr reader, out Frame frame);
        [DllImport(Library)] static extern int wade_latest_leave(IntPtr reader);
        [DllImport(Library)] static extern void wade_latest_free(IntPtr reader);

        IntPtr reader;
        readonly Info info;
        readonly bool agents;
        float[][] places = new float[3][], velocities = new float[3][];

        public int Count { get; private set; }
        public ulong Number { get; private set; }
        public double TimeS { get; private set; }
        public bool Final { get; private set; }
        public double ParticleRadius { get { return info.ParticleRadius; } } // m; 0: not given

        // Of length Count or more; the same arrays from frame to frame as long as they are long enough.
        public float[] X { get { return places[0]; } }
        public float[] Y { get { return places[1]; } }
        public float[] Z { get { return places[2]; } }
        public float[] Vx { get { return velocities[0]; } }
        public float[] Vy { get { return velocities[1]; } }
        public float[] Vz { get { return velocities[2]; } }
        public float[] Mass = new float[0];                            // kg
        public float[] Radius = new float[0], Height = new float[0];   // m; people only
        public float[] State = new float[0];                           // people only: 0 walking, 1 arrived, 2 dead

        /// <summary>Joins a session. people: its agents (scenes with /coupling/agents_stream), else the water.</summary>
        public Stream(string session, bool people = false, double attachTimeoutS = 10, uint stride = 1)
        {
            if (wade_abi_version() != AbiVersion) throw new StreamException(2, "libwade_shm has another ABI than version 1.");
            Join join;
            wade_join_defaults(out join);
            agents = people;
            join.Kind = people ? 2u : 1u;
            join.AttachTimeout = attachTimeoutS;
            Check(wade_latest_open(session, "csharp", ref join, stride, out reader));
            Check(wade_latest_stream(reader, out info));
            for (int i = 0; i < 3; ++i) places[i] = velocities[i] = new float[0];
        }

        /// <summary>Takes the newest frame if there is one that was not taken yet. Never waits.</summary>
        public News Poll()
        {
            Frame frame;
            int result = wade_latest_poll(reader, out frame);
            if (result == NothingNew) return News.Nothing;
            if (result == AtEnd) return News.End;
            Check(result);
            Count = (int)frame.Count;
            Number = frame.Number;
            TimeS = frame.Tick / (double)info.TicksPerSecond;
            Final = frame.Final != 0;
            IntPtr[] p = { frame.Px, frame.Py, frame.Pz }, v = { frame.Vx, frame.Vy, frame.Vz };
            int[] axes = { info.AxisX, info.AxisY, info.AxisZ };
            double[] origin = { info.OriginX, info.OriginY, info.OriginZ };
            for (int i = 0; i < 3; ++i)
            {
                int stored = Math.Abs(axes[i]) - 1;
                double scale = axes[i] > 0 ? info.Metres : -info.Metres;
                Copy(p[stored], ref places[i], scale, origin[i]);
                Copy(v[stored], ref velocities[i], scale, 0);
            }
            Copy(frame.Mass, ref Mass, 1, 0);
            if (!agents) return News.Frame;
            Copy(frame.Radius, ref Radius, info.Metres, 0);
            Copy(frame.Height, ref Height, info.Metres, 0);
            Copy(frame.State, ref State, 1, 0);
            return News.Frame;
        }

        void Copy(IntPtr from, ref float[] into, double scale, double origin)
        {
            if (into.Length < Count) into = new float[Count + Count / 2];
            Marshal.Copy(from, into, 0, Count);
            if (scale == 1 && origin == 0) return;
            for (int k = 0; k < Count; ++k) into[k] = (float)(origin + scale * into[k]);
        }

        static void Check(int result)
        {
            if (result != Ok) throw new StreamException(result, Marshal.PtrToStringAnsi(wade_last_error()));
        }

        public void Dispose()
        {
            if (reader == IntPtr.Zero) return;
            wade_latest_leave(reader);
            wade_latest_free(reader);
            reader = IntPtr.Zero;
        }
    }
}
