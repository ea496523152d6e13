"""A case file that several tests read, change or damage."""

CASE = """\
[muscle]
ends = "clamped"
[muscle.braid]
radius = "12.5 mm"
length = "85 mm"
angle = "37 deg"
fibres = 56
fibre = { diameter = "0.25 mm", E = "3 GPa", nu = 0.4 }
[muscle.chamber]
thickness = "1 mm"
law = { name = "mooney-rivlin", c1 = "8.5 kPa", c2 = "0 Pa" }
[test]
kind = "isometric"
length = "115 mm"
pressure = "0 to 1 bar"
points = 21
"""
