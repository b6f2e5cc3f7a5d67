"""A hand on another host. There: knurl-bridge keygen --keys bridge.keys --name anna --role control
                               knurl-bridge --listen 0.0.0.0:4096 --keys bridge.keys
Here: a file of mode 0600 with anna's line of bridge.keys, then

    07_remote.py --servo knurl://HOST:4096 --key anna.key
"""
import knurl
from session import options, turns

said = options(__doc__, lambda parser: parser.add_argument("--key", help="file with your line of the bridge's keys"))
with knurl.connect(said.servo, key_file=said.key) as client, client.claim() as hand:
    hand.add(knurl.Plane(normal=(0, 0, 1), stiffness=500))  # as stiff as at home: the servo there renders it
    hand.arm()
    for report in turns(said, hand):
        age, within = hand.age(report)
    network = hand.network
    print(f"a report is {age * 1e3:.1f} ms old (to {within * 1e3:.2f} ms), round trip {network.round_trip * 1e3:.2f} ms, "
          f"{network.lost} lost, encrypted: {network.encrypted}")
