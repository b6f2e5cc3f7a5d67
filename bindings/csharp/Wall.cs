// A floor that the hand touches from above, in C# (Mono, .NET, Unity). Prints what is felt.
//     mcs Wall.cs && mono Wall.exe 30
using System;
using System.Runtime.InteropServices;

static class Wall {
    [StructLayout(LayoutKind.Sequential)]
    struct Vector { public double x, y, z; }
    [StructLayout(LayoutKind.Explicit, Size = 400)]
    struct Device { [FieldOffset(0)] public ulong size; [FieldOffset(336)] public Vector centre; }
    // knurl_plane: the members that are set here; the others keep their defaults.
    [StructLayout(LayoutKind.Explicit, Size = 248)]
    struct Plane { [FieldOffset(0)] public ulong size; [FieldOffset(32)] public double offset; [FieldOffset(72)] public double stiffness; }
    [StructLayout(LayoutKind.Sequential)]
    struct Feedback {
        public ulong size; public Vector force, torque, contact;
        public double stiffness, tangential, share, damping_share;
        public ulong cycle; public uint flags, reserved;
    }
    const string Library = "libknurl.so.0";
    [DllImport(Library)] static extern int knurl_connect(string address, IntPtr options, out IntPtr client);
    [DllImport(Library)] static extern int knurl_claim(IntPtr client, string device, IntPtr options, out IntPtr hand);
    [DllImport(Library)] static extern int knurl_device_of(IntPtr hand, ref Device device);
    [DllImport(Library)] static extern int knurl_default(uint kind, ref Plane plane, ulong size);
    [DllImport(Library)] static extern int knurl_add(IntPtr hand, uint kind, ref Plane plane, IntPtr options, out ulong id);
    [DllImport(Library)] static extern int knurl_arm(IntPtr hand);
    [DllImport(Library)] static extern int knurl_commit(IntPtr hand, IntPtr number);
    [DllImport(Library)] static extern int knurl_wait_applied(IntPtr hand, ulong number, long timeoutNs);
    [DllImport(Library)] static extern int knurl_feedback_of(IntPtr hand, ulong id, ref Feedback felt);
    [DllImport(Library)] static extern int knurl_close(IntPtr handle);
    [DllImport(Library)] static extern IntPtr knurl_error(IntPtr handle);

    static int Check(int code) {
        if (code < 0) throw new Exception(Marshal.PtrToStringAnsi(knurl_error(IntPtr.Zero)));
        return code;
    }

    static void Main(string[] arguments) {
        double seconds = arguments.Length > 0 ? double.Parse(arguments[0]) : 30, most = 0;
        Check(knurl_connect(null, IntPtr.Zero, out IntPtr client));
        Check(knurl_claim(client, null, IntPtr.Zero, out IntPtr hand));
        var device = new Device { size = (ulong)Marshal.SizeOf(typeof(Device)) };
        Check(knurl_device_of(hand, ref device));
        var floor = new Plane();
        Check(knurl_default(0, ref floor, (ulong)Marshal.SizeOf(typeof(Plane))));
        floor.offset = device.centre.z + 0.002;  // m: the hand at rest is 2 mm within
        floor.stiffness = 800;                   // N/m
        Check(knurl_add(hand, 0, ref floor, IntPtr.Zero, out ulong id));
        Check(knurl_arm(hand));
        var felt = new Feedback { size = (ulong)Marshal.SizeOf(typeof(Feedback)) };
        for (var start = DateTime.UtcNow; (DateTime.UtcNow - start).TotalSeconds < seconds;) {
            Check(knurl_commit(hand, IntPtr.Zero));
            Check(knurl_wait_applied(hand, 0, 50000000));
            if (Check(knurl_feedback_of(hand, id, ref felt)) == 0) most = Math.Max(most, felt.force.z * felt.share);
        }
        Check(knurl_close(client));
        Console.WriteLine("felt up to {0:F2} N", most);
    }
}
