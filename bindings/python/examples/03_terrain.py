"""Hills from an image: 8 cm wide, 1 cm high. Give your own with --image (it needs Pillow), else these are computed."""
import numpy as np

import knurl
from session import connected, options, turns


def hills(size=200):
    """A grey picture of two hills and ripples."""
    y, x = np.mgrid[-1 : 1 : size * 1j, -1 : 1 : size * 1j]
    height = np.exp(-6 * ((x - 0.3) ** 2 + y**2)) + 0.6 * np.exp(-9 * ((x + 0.4) ** 2 + (y - 0.2) ** 2)) + 0.05 * np.sin(14 * x)
    return np.uint8(255 * (height - height.min()) / np.ptp(height))


said = options(__doc__, lambda parser: parser.add_argument("--image", help="picture: black is low, white is high"))
image = hills()
if said.image:
    from PIL import Image

    image = Image.open(said.image).convert("L")
stroke = [(0, -0.03, 0, 0.02), (1, -0.03, 0, 0.0), (4, 0.03, 0, 0.0)]
with connected(said, hand=stroke) as client, client.claim() as hand:
    sent = hand.send_image(image, size=0.08, height=0.01)
    print(f"{sent.faces} faces, {sent.bytes} bytes in the servo, {sent.low[2] * 1e3:.1f} to {sent.high[2] * 1e3:.1f} mm high")
    terrain = hand.add(knurl.Shape.made_of("rubber", asset=sent.asset, shading="smooth"))
    hand.arm()
    for report in turns(said, hand):
        felt = terrain.feedback
        if felt is not None and felt.touching and report.cycle % 25 < 17:
            print(f"\r{report.position[2] * 1e3:+6.2f} mm {np.linalg.norm(felt.force):5.2f} N", end="", flush=True)
print()
