// The newest frame of a Wade session, for Unity and any other program in C#, through the C ABI (libwade_shm.so, Linux).
//
//     using (var water = new Wade.Stream("demo"))
//         while (water.Poll() != Wade.News.End)     // once a picture; never waits
//             Draw(water.X, water.Y, water.Z, water.Count);
//
// A free-running reader: it holds up nobody and may miss frames. Places and velocities are in metres, x upstream, y up,
// z across: left-handed, as Unity's axes, so that new Vector3(X[i], Y[i], Z[i]) is the place (docs/engines.md).
// For a project of Unity: this file into Assets, libwade_shm.so into Assets/Plugins. Where there is no shared memory of Linux,
// as on Windows, WebStream takes the water from the server of the viewer: new Wade.WebStream("http://127.0.0.1:PORT/?key=KEY"),
// the address that wade_view_server prints.
using System;
using System.IO;
using System.Net;
using System.Net.WebSockets;
using System.Runtime.InteropServices;
using System.Text;
using System.Threading;
using System.Threading.Tasks;

namespace Wade
{
    public enum News { Nothing, Frame, End }

    /// <summary>What the session or the library says is wrong; Code is an exit code of docs/protocol.md.</summary>
    public sealed class StreamException : Exception
    {
        public readonly int Code;
        public StreamException(int code, string text) : base(text) => Code = code;
    }

    public sealed class Stream : IDisposable
    {
        const int Ok = 0, AtEnd = -1, NothingNew = -2, AbiVersion = 2;

        struct Join // wade_join
        {
            public ulong SceneHash;
            public uint Kind, Follows, GroupAccess, Reserved;
            public double AttachTimeout, StepWarning, StepTimeout;
            public IntPtr Interrupted, Warn, Context;
        }

        [StructLayout(LayoutKind.Explicit, Size = 200)]
        struct Info // wade_stream, as far as it is read here
        {
            [FieldOffset(80)] public ulong TicksPerSecond;
            [FieldOffset(96)] public double Metres;
            [FieldOffset(104)] public double OriginX; [FieldOffset(112)] public double OriginY; [FieldOffset(120)] public double OriginZ;
            [FieldOffset(128)] public int AxisX; [FieldOffset(132)] public int AxisY; [FieldOffset(136)] public int AxisZ;
            [FieldOffset(144)] public double ParticleRadius;
        }

        [StructLayout(LayoutKind.Sequential, Size = 304)]
        struct Frame // wade_frame, without its diagnostics
        {
            public ulong Number, Tick, Hash;
            public uint Count, Final;
            public IntPtr Mass, Vx, Vy, Vz, Px, Py, Pz, Radius, Height, State;
        }

        const string Library = "wade_shm"; // lib and .so are added
        [DllImport(Library)] static extern uint wade_abi_version();
        [DllImport(Library)] static extern IntPtr wade_last_error();
        [DllImport(Library)] static extern void wade_join_defaults(out Join join);
        [DllImport(Library)] static extern int wade_latest_open(string session, string name, ref Join join, uint stride, out IntPtr r);
        [DllImport(Library)] static extern int wade_latest_stream(IntPtr reader, out Info info);
        [DllImport(Library)] static extern int wade_latest_poll(IntPtr reader, out Frame frame);
        [DllImport(Library)] static extern void wade_latest_free(IntPtr reader);

        IntPtr reader;
        readonly Info info;
        readonly bool agents;
        public ulong Number; // from 1 on
        public int Count;
        public bool Final;
        public double TimeS;
        public double ParticleRadius => info.ParticleRadius; // m; 0: not given
        // m, m/s, kg, of length Count or more; radius, height (m) and state (0 walking, 1 arrived, 2 dead) of people only.
        public float[] X = new float[0], Y = new float[0], Z = new float[0];
        public float[] Vx = new float[0], Vy = new float[0], Vz = new float[0];
        public float[] Mass = new float[0], Radius = new float[0], Height = new float[0], State = new float[0];

        /// <summary>Joins a session. people: its agents (scenes with /coupling/agents_stream), else the water.</summary>
        public Stream(string session, bool people = false, double attachTimeoutS = 10, uint stride = 1)
        {
            if (wade_abi_version() != AbiVersion) throw new StreamException(2, "libwade_shm has another ABI than version 2.");
            wade_join_defaults(out Join join);
            agents = people;
            join.Kind = people ? 2u : 1u;
            join.AttachTimeout = attachTimeoutS;
            Check(wade_latest_open(session, "csharp", ref join, stride, out reader));
            Check(wade_latest_stream(reader, out info));
        }

        /// <summary>Takes the newest frame if there is one that was not taken yet. Never waits.</summary>
        public News Poll()
        {
            int result = wade_latest_poll(reader, out Frame frame);
            if (result == NothingNew || result == AtEnd) return result == AtEnd ? News.End : News.Nothing;
            Check(result);
            Count = (int)frame.Count;
            Number = frame.Number;
            TimeS = frame.Tick / (double)info.TicksPerSecond;
            Final = frame.Final != 0;
            IntPtr[] p = { frame.Px, frame.Py, frame.Pz }, v = { frame.Vx, frame.Vy, frame.Vz };
            Turn(info.AxisX, info.OriginX, p, v, ref X, ref Vx);
            Turn(info.AxisY, info.OriginY, p, v, ref Y, ref Vy);
            Turn(info.AxisZ, info.OriginZ, p, v, ref Z, ref Vz);
            Copy(frame.Mass, ref Mass, 1, 0);
            if (!agents) return News.Frame;
            Copy(frame.Radius, ref Radius, info.Metres, 0);
            Copy(frame.Height, ref Height, info.Metres, 0);
            Copy(frame.State, ref State, 1, 0);
            return News.Frame;
        }

        void Turn(int axis, double origin, IntPtr[] p, IntPtr[] v, ref float[] place, ref float[] velocity)
        {
            double scale = axis > 0 ? info.Metres : -info.Metres;
            Copy(p[Math.Abs(axis) - 1], ref place, scale, origin);
            Copy(v[Math.Abs(axis) - 1], ref velocity, scale, 0);
        }

        void Copy(IntPtr from, ref float[] into, double scale, double origin)
        {
            if (into.Length < Count) into = new float[Count + Count / 2];
            Marshal.Copy(from, into, 0, Count);
            if (scale == 1 && origin == 0) return;
            for (int k = 0; k < Count; ++k) into[k] = (float)(origin + scale * into[k]);
        }

        static int Check(int code) => code == Ok ? Ok : throw new StreamException(code, Marshal.PtrToStringAnsi(wade_last_error()));

        public void Dispose()
        {
            wade_latest_free(reader); // says goodbye before; takes a null pointer, too
            reader = IntPtr.Zero;
        }
    }

    /// <summary>The newest frame of a session that the server of the viewer shows live, over its WebSocket.</summary>
    public sealed class WebStream : IDisposable
    {
        readonly ClientWebSocket socket = new ClientWebSocket();
        readonly byte[] part = new byte[1 << 16];
        readonly MemoryStream whole = new MemoryStream();
        Task<WebSocketReceiveResult> receiving;
        int ended; // how often the server has said so since the last frame

        public int Count;
        public double Number, TimeS;
        public float[] X, Y, Z, Vx, Vy, Vz, Volume; // m, m/s, m3, of length Count

        /// <summary>Connects to the server by the address, with its key, that the server prints.</summary>
        public WebStream(string address)
        {
            var page = new Uri(address);
            if (page.Query.StartsWith("?key="))
            {
                socket.Options.Cookies = new CookieContainer();
                socket.Options.Cookies.Add(page, new Cookie("wade_" + page.Port, page.Query.Substring(5)));
            }
            socket.ConnectAsync(new Uri("ws://" + page.Authority + "/stream"), CancellationToken.None).Wait();
            Ask();
        }

        void Ask()
        {
            var question = new ArraySegment<byte>(Encoding.ASCII.GetBytes("{\"get\":\"live\",\"after\":" + (long)Number + "}"));
            socket.SendAsync(question, WebSocketMessageType.Text, true, CancellationToken.None).Wait();
        }

        /// <summary>As Stream.Poll.</summary>
        public News Poll()
        {
            for (;;)
            {
                receiving = receiving ?? socket.ReceiveAsync(new ArraySegment<byte>(part), CancellationToken.None);
                if (!receiving.IsCompleted) return News.Nothing;
                WebSocketReceiveResult got = receiving.Result;
                receiving = null;
                if (got.MessageType == WebSocketMessageType.Close) return News.End;
                whole.Write(part, 0, got.Count);
                if (!got.EndOfMessage) continue;
                byte[] message = whole.ToArray();
                whole.SetLength(0);
                if (got.MessageType == WebSocketMessageType.Binary) return Take(message);
                if (Encoding.UTF8.GetString(message).Contains("\"state\":\"ended\"") && ++ended > 1) return News.End;
            }
        }

        News Take(byte[] message) // viewer/README.md: a head of 56 bytes, then x, y, z, vx, vy, vz and volume
        {
            Count = BitConverter.ToInt32(message, 8);
            TimeS = BitConverter.ToDouble(message, 16);
            Number = BitConverter.ToDouble(message, 24);
            float[][] a = new float[7][];
            for (int i = 0; i < 7; ++i) Buffer.BlockCopy(message, 56 + 4 * i * Count, a[i] = new float[Count], 0, 4 * Count);
            X = a[0]; Y = a[1]; Z = a[2]; Vx = a[3]; Vy = a[4]; Vz = a[5]; Volume = a[6];
            ended = 0;
            Ask();
            return News.Frame;
        }

        public void Dispose() { socket.Dispose(); }
    }
}
