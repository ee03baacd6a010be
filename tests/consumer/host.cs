// The host of host.c in C#: streams samples, then draws a surface along a path.
using System;
using System.Globalization;
using System.Runtime.InteropServices;

static class Host
{
    const string Library = "libhelibore.so.0.1";  // Windows: libhelibore.dll

    [StructLayout(LayoutKind.Sequential)]
    struct Settings
    {
        public uint size;
        public int sectors;
        public double bitDiameter, pitch, startDepth, stopDepth, startToolface;
        public long window, mostVertices;
        public double power, maxDistance, tolerance, angularScale, krigingRange, nugget;
        public int neighbors, maxIterations, estimator, direct, threads, instructionSet;
    }

    [StructLayout(LayoutKind.Sequential)]
    struct PathSettings
    {
        public uint size;
        public int method, reference, reserved;
        public double headNorth, headEast, headDown, extend;
    }

    [StructLayout(LayoutKind.Sequential)]
    struct Change { public uint size; public int reserved; public long ranges, settled, accepted, redundant; }

    [StructLayout(LayoutKind.Sequential)]
    struct State { public uint size; public int reserved; public long vertices, samples, settled; public double startDepth; }

    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)] static extern IntPtr hb_last_error();
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)] static extern int hb_close(long handle);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)] static extern int hb_settings_init(ref Settings settings);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)] static extern int hb_path_settings_init(ref PathSettings settings);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)] static extern int hb_wall_create(ref Settings settings, out long wall);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)] static extern int hb_wall_get(long wall, ref State state);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    static extern int hb_wall_append(long wall, long n, double[] depth, double[] toolface, double[] radius, double[] time, ref Change change);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    static extern int hb_path_create(ref PathSettings settings, long n, double[] depth, double[] inclination, double[] azimuth, out long path);
    [DllImport(Library, CallingConvention = CallingConvention.Cdecl)]
    static extern int hb_wall_surface(long wall, long path, long start, long stop, ref long vertexCount, double[] vertices, long[] vertexIndex, ref long quadCount, long[] quads);

    static void Check(int status)
    {
        if (status != 0) throw new Exception(Marshal.PtrToStringAnsi(hb_last_error()));
    }

    static void Main()
    {
        CultureInfo.CurrentCulture = CultureInfo.InvariantCulture;
        var settings = new Settings { size = (uint)Marshal.SizeOf(typeof(Settings)) };
        Check(hb_settings_init(ref settings));
        settings.bitDiameter = 0.216;
        settings.sectors = 32;
        settings.startDepth = 1000;
        long wall, path, vertexCount = 0, quadCount = 0;
        Check(hb_wall_create(ref settings, out wall));

        double[] depth = new double[1000], toolface = new double[1000], radius = new double[1000];
        var change = new Change { size = (uint)Marshal.SizeOf(typeof(Change)) };
        for (int packet = 0; packet < 5; ++packet)
        {
            for (int i = 0; i < 1000; ++i)
            {
                depth[i] = 1000 + packet + i * 0.001;
                toolface[i] = i * 37 % 360;
                radius[i] = 0.11 + (packet == 2 ? 0.02 : 0);
            }
            Check(hb_wall_append(wall, 1000, depth, toolface, radius, null, ref change));
            Console.WriteLine("{0} samples, {1} changed ranges, settled to {2}", change.accepted, change.ranges, change.settled);
        }

        var how = new PathSettings { size = (uint)Marshal.SizeOf(typeof(PathSettings)) };
        Check(hb_path_settings_init(ref how));
        Check(hb_path_create(ref how, 3, new double[] { 0, 500, 1100 }, new double[] { 0, 10, 35 }, new double[] { 40, 40, 55 }, out path));
        var state = new State { size = (uint)Marshal.SizeOf(typeof(State)) };
        Check(hb_wall_get(wall, ref state));
        hb_wall_surface(wall, path, 0, state.vertices, ref vertexCount, null, null, ref quadCount, null);
        var vertices = new double[3 * vertexCount];
        var quads = new long[4 * quadCount];
        Check(hb_wall_surface(wall, path, 0, state.vertices, ref vertexCount, vertices, null, ref quadCount, quads));
        Console.WriteLine("{0} vertices, {1} quads, first at {2:F6} {3:F6} {4:F6}", vertexCount, quadCount, vertices[0], vertices[1], vertices[2]);

        toolface[17] = double.NegativeInfinity;
        if (hb_wall_append(wall, 1000, depth, toolface, radius, null, ref change) != 1) Environment.Exit(1);
        Console.WriteLine(Marshal.PtrToStringAnsi(hb_last_error()));
        Check(hb_close(path));
        Check(hb_close(wall));
    }
}
