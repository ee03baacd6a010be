"""Roles in the headers of real wells and tools: names, units and what they are, with the role that each must have.

A table names the tool or the country first. Its lines are NAME | unit | description | role [angle or reference]; lines
without a role have none. Numbered columns stand as NAME1..NAME16. The lines are those that some rule could take for a
role, and a few others.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import helibore as hb
from helibore.channels.log_set import LogSet
from helibore.channels.roles import guess
from helibore.channels.sectors import join_sectors
from helibore.files.raw_set import Channel

HEADERS = """
# natural gamma, wireline, North Dakota
DEPT | F | depth (borehole) | depth
BS | IN | bit size | bit-diameter
CHI1 | | detector 1, chi squared
CHI2 | | detector 2, chi squared
HBHK | CFCF | borehole potassium
# triple combination, wireline, North Dakota
DEPT | F | depth (borehole) | depth
AF20 | OHMM | array induction, four feet, A20
AF30 | OHMM | array induction, four feet, A30
HCAL | IN | HRCC cal. caliper | mean-diameter
# sonic with two powered calipers, wireline, North Dakota
DEPT | F | depth (borehole) | depth
TDEP | .1IN |
HD2_PPC2 | IN | PPC2 hole diameter 2
HD1_PPC2 | IN | PPC2 hole diameter 1
HD2_PPC1 | IN | PPC1 hole diameter 2 | diameter 90
HD1_PPC1 | IN | PPC1 hole diameter 1 | diameter 0
VPVS | | ratio of velocities, compressional to shear
BS | IN | bit size | bit-diameter
# powered caliper, wireline: the channels of its tool
DEPT | ft | depth | depth
HD1_PPC1 | in | hole diameter 1 | diameter 0
HD2_PPC1 | in | hole diameter 2 | diameter 90
RB_PPC1 | deg | relative bearing | toolface high-side
ERA_PPC1 | deg | angle between the long axis of the ellipse and caliper 1-3
PHWA_PPC1 | deg | angle of pad and hole wall
CRD1_PPC1 | in | radius 1 with the arm's bending
CRD2_PPC1 | in | radius 2 with the arm's bending
HDOV_PPC1 | in | hole diameter from the oval
# magnetic resonance, wireline, North Dakota
DEPT | F | depth (borehole) | depth
BS | IN | bit size | bit-diameter
CBP1..CBP8 | CFCF | CMR bin porosity
CMRP_3MS | CFCF | porosity beyond 3 ms
TENS | LBF | cable tension
# magnetic resonance and deviation, wireline, North Dakota
DEPT | F | depth (borehole) | depth
DCAL | IN | differential caliper
GDEV | DEG | hole deviation from gravity | inclination
ED | F | east departure
ND | F | north departure
STIT | F | stuck tool indicator
CBP1..CBP8 | CFCF | CMR bin porosity
# density and neutron, LAS 1.2, Alberta
DEPT | M | DEPTH | depth
CALI | MM | CALI | mean-diameter
DNEAR | G/CM3 | DNEAR
GAMN | GAPI | GAMN
# composite of the 1980s, Kansas
DEPT | FT | depth | depth
DLCL | INCHES | caliper | mean-diameter
ACCL1 | INCHES | density caliper | mean-diameter
ACCL2 | INCHES | neutron caliper | mean-diameter
ACTC | US/FT | sonic interval transit time (compensated)
# cased hole, ultrasonic
DEPT | F | depth (borehole) | depth
UFLG[36] | | processing flag
IRAV | IN | internal radius, averaged
IRMN | IN | internal radius, minimum
IRMX | IN | internal radius, maximum
ERAV | IN | external radii, average
THMX | IN | thickness, maximum
LC07 | | external radius less the maximum internal radius
# sonic and induction, LIS, New Zealand
X | .1IN | X axis (implied) | depth
BS | IN | bit size | bit-diameter
TIME | MS | time | time
ETIM | S | elapsed time
RCAL | IN |
CALI | IN | caliper | mean-diameter
IHV | M3 | integrated hole volume
TT1 | US | transit time 1
TT2 | US | transit time 2
TT3 | US | travel time (filtered) (transmitter 1 - receiver 3)
TT4 | US | transit time 4
TT | US | transit time image array
ITT | S | integrated transit time
DIFF | M |
# density, neutron and spectral gamma, LIS, New Zealand
DEPT | M | depth | depth
BS | IN | bit size | bit-diameter
CALI | IN | caliper | mean-diameter
LA | IN |
SA | IN |
SS1 | CPS |
SS2 | CPS |
W5NG | CPS | window 5
W4NG | CPS | window 4
# induction, BIT, North Sea
X | | computed X axis
COND | | conductivity
CAL | | caliper | mean-diameter
SPD | | speed
# station log by time, DLIS, North Sea
TIME | ms | 1 second river time | time
TDEP | 0.1 in | 1 second river depth | depth
TENS_SL | lbf | cable tension
DEPT_SL | 0.1 in | station logging depth
# coring tool, DLIS, North Sea
TIME | ms | time channel | time
TDEP | 0.1 in | depth channel of the tool | depth
ETIM | s | elapsed logging time
OCD | ft | observed core depth
RCPP | in | raw position of the piston
CMPP | in | position of the piston
CMLP | in | linear position of the motor
# composite, Netherlands
DEPT | M | index curve | depth
GR | GAPI | gamma ray
DT | US/F | acoustic compressional slowness
DRHO | G/C3 | density correction
# two calipers of two runs, Netherlands
DEPT | M | index curve | depth
SN | OHMM | IEL
RHOB | G/C3 | FDC
CAL1 | IN | FDC | mean-diameter
CAL2 | IN | BHC | mean-diameter
# composite, Norway
DEPT | M | depth | depth
AC | US/F | sonic transit time (slowness)
CALI | IN | caliper | mean-diameter
NEU | % | neutron porosity
# composite without descriptions, Norway
DEPTH | m | | depth
BS | inches | | bit-diameter
CALI | inches | | mean-diameter
N | v/v |
# density quadrants of LWD, Norway
DEPT | ft | | depth
ABDCQF01..ABDCQF04 | g/cm3 | | image
BS | inches | | bit-diameter
CALI | inches | | mean-diameter
# density and gamma images, LWD, Netherlands
DEPTH | m | depth hole | depth
RPTHM | min | resistivity, time since drilled
NPCKLFM | pu | neutron porosity, caliper and salinity corrected
TVD | m | true vertical depth | tvd
INNM | deg | inclination, not rotating | inclination
BLOCKCOMP | m | block position, compensated
ABDCUM | g/cc | azimuthal bulk density, up
ABDC1M..ABDC16M | g/cc | azimuthal bulk density, sector | image
ABDCM | g/cc | azimuthal bulk density, image
GRAS0M..GRAS7M | API | azimuthal gamma ray, sector | image
# density, gamma and resistivity images, LWD, Norway
TDEP | m | frame 0 depth | depth
BITSIZE | in | bit size | bit-diameter
GRCS01M..GRCS08M | gAPI | | image
GRCDFM | gAPI | azimuthal gamma ray, down quadrant
CALCM | in | acoustic caliper, corrected | mean-diameter
ABDC01M..ABDC16M | g/cm3 | azimuthal bulk density, sector | image
APRA01M..APRA16M | | | image
NPCLFM | | neutron porosity, caliper, filtered
NPCKSFM | | neutron porosity, sandstone matrix, salinity and caliper
INNM | deg | inclination, not rotating | inclination
AT2GTFM | deg | | toolface high-side
SSRPMAXM | c/min | stick slip, maximum
# density and ultrasonic calipers, LWD, Norway
DEPT | 0.1 in | | depth
DCAV | IN | density caliper, average | mean-diameter
DCHO | IN | density caliper, horizontal | diameter 90
DCVE | IN | density caliper, vertical | diameter 0
UCAV | IN | ultrasonic caliper, average diameter | mean-diameter
UCHO | IN | ultrasonic caliper, horizontal diameter | diameter 90
UCVE | IN | ultrasonic caliper, vertical diameter | diameter 0
DRHB | G/CC | bulk density correction, bottom
TAB_ARC_RES | S | resistivity, time after bit
# directions of LWD, ocean drilling
DEPT | m | depth | depth
MTF | deg | magnetic toolface | toolface north
ATEMP_C | degC | annular temperature
CRPM_RT | rpm | collar rotation
C_PEAK3_S | | peaks with coherence and travel time
# triple combination, Kansas
DEPT | F | depth | depth
CALI | in | caliper | mean-diameter
RT90 | ohmm | 90 in resistivity, 2 ft
RT10 | ohmm | 10 in resistivity, 2 ft
# tops, LAS 3, Kansas
TOPT | F | top depth | depth
TOPB | F | base depth
RANK | | rank of the unit
# drill stem test, LAS 3, Kansas
_T_TIME | MIN | time | time
_T_TEMP | DEG | temperature
_T_CHOKE | IN | choke
_T_LEN | FT | length
# geological report, LAS 3, Kansas
GEOTOP | F | remarks, top depth | depth
GEOBASE | F | remarks, bottom depth
GEOBED | F | bed thickness
# laterolog and density, Nova Scotia
DEPT | m | | depth
CALI | in | caliper | mean-diameter
HCAL | in | HRCC cal. caliper | mean-diameter
RLA1 | ohm.m | borehole corrected resistivity 1
RLA2 | ohm.m | borehole corrected resistivity 2
DPHI_SAN | m3/m3 | density porosity (matrix sandstone)
# two-way time of a seismic tie, Nova Scotia
DEPT | m | DEPTH | depth
TWT | ms | TWT
# geothermal hole, LAS, Germany
DEPT | M | borehole depth | depth
BHT | degC | borehole temperature
CALIPER | MM | borehole caliper | mean-diameter
ZDNC | g/ccm | caliper corrected density
DIP | deg | dip
AZI | deg | azimuth
# geothermal hole, DLIS, Germany
DEPTH | m | borehole depth (tool depth) | depth
CALIPER.PD | mm | borehole caliper | mean-diameter
ZCOR.PD | g/cm3 | density correction
RLL8CX10.DI2 | ohmm | resistivity, borehole corrected
# imager with 192 buttons, LAS
TDEP | .1in | borehole depth | depth
ETIM | s | elapsed logging time | time
DEVI | deg | deviation | inclination
P1AZ | deg | pad 1 azimuth | toolface horizontal-north
ANOR | m/s2 | acceleration computed norm
FCAX | m/s2 | X acceleration
FCD4[0]..FCD4[11] | | FMI buttons, pad D, row 4
# high-resolution dip meter, LIS
DEPT | M | depth | depth
C1 | IN | caliper 1 | diameter 0
C2 | IN | caliper 2 | diameter 90
RC1 | IN | raw caliper 1
RC2 | IN | raw caliper 2
RB | DEG | relative bearing | toolface high-side
P1AZ | DEG | pad 1 azimuth in the horizontal plane
AZIM | DEG | measured azimuth
HAZI | DEG | hole azimuth relative to true north | azimuth
DEVI | DEG | deviation | inclination
RDEV | DEG | raw deviation
FC1..FC4 | | fast channel
FEP1 | | far electrode potential 1
FEP2 | | far electrode potential 2
# X-Y caliper of a production tool, Norway
depth_m | m | | depth
pfc1_x_in | in | | diameter 0
pfc2_y_in | in | | diameter 90
rb_deg | deg | | toolface high-side
"""

NUMBERED = re.compile(r"(?P<start>\D*?(?:FCD4\[)?)(?P<first>\d+)(?P<end>[^\d.]*)\.\.(?P<last>\S+)")


def members(name: str) -> list[str]:
    """Return the names of numbered columns: ABDC01M..ABDC16M."""
    match = NUMBERED.fullmatch(name)
    if match is None:
        return [name]
    first, width = int(match["first"]), len(match["first"])
    last = int(match["last"].removeprefix(match["start"]).removesuffix(match["end"]))
    return [f"{match['start']}{number:0{width}d}{match['end']}" for number in range(first, last + 1)]


def tables() -> dict[str, list[list[str]]]:
    """Return the lines of each header, cut at the bars."""
    found = {}
    for block in HEADERS.strip().split("# ")[1:]:
        title, *lines = block.strip().split("\n")
        found[title] = [([cell.strip() for cell in line.split("|")] + [""])[:4] for line in lines]
    return found


TABLES = tables()


def test_the_headers_are_thirty_and_more() -> None:
    assert len(TABLES) >= 30
    assert sum(map(len, TABLES.values())) > 200


@pytest.mark.parametrize("title", TABLES)
def test_no_channel_of_a_real_header_has_a_wrong_role(title: str) -> None:
    channels, wanted = [], {}
    for name, unit, described, role in TABLES[title]:
        names = members(name)
        channels += [Channel(each, unit, described, np.ones(3)) for each in names]
        wanted |= dict.fromkeys(names, role)
    joined, _ = join_sectors(channels, channels[0].name)
    found = {}
    for role in guess(LogSet(Path("f.las"), "log", joined, 3, channels[0].name)):
        more = {"diameter": f" {role.angle:g}" if role.angle is not None else "", "toolface": f" {role.reference}"}
        text = "" if role.role == "none" else role.role + more.get(role.role, "")
        channel = next(each for each in joined if each.name == role.channel)
        found |= dict.fromkeys(channel.member_names or (role.channel,), text)
    assert found == wanted


SURVEYS = {
    "SLB": ("DEPT", "DEVI", "HAZI"),
    "SLB, imager": ("TDEP", "DEVIM", "HAZIM"),
    "Halliburton": ("DEPT", "DEV", "HAZ"),
    "Halliburton, LWD": ("DEPTH", "INC", "AZM"),
    "Baker": ("DEPTH", "DEVCB", "DAZCB"),
    "Baker, GX": ("DEPTH", "DEVGX", "DAZGX"),
    "Weatherford": ("DEPT", "ITLT", "IAZI"),
    "Reeves": ("DEPT", "SINCL", "SAZIMC"),
    "Petrel": ("MD", "INCL", "AZIM_TN"),
    "Compass": ("MD", "Inc", "Azi"),
    "Techlog": ("MD", "INCLINATION", "AZIMUTH"),
    "sonde and pad": ("DEPT", "SDEV", "HAZIM"),
}


@pytest.mark.parametrize("vendor", SURVEYS)
def test_the_path_by_the_names_of_each_vendor(tmp_path: Path, vendor: str) -> None:
    """A hole that builds to 60 degrees at 1 degree in 10 m, turns, and holds; other angles stand beside its own."""
    depth = np.arange(0.0, 2001.0, 10.0)
    inclination = np.clip((depth - 500) / 10, 0, 60)
    azimuth = np.clip(40 + (depth - 1100) / 10, 40, 90)
    pad = (depth * 7) % 360
    names = ("P1AZ", *SURVEYS[vendor], "RB")
    units = ("deg", "m", "deg", "deg", "deg")
    cells = np.column_stack([pad, depth, inclination, azimuth, (pad + 90) % 360])
    lines = [",".join(names), ",".join(units), *(",".join(f"{cell:.4f}" for cell in row) for row in cells)]
    (tmp_path / "s.csv").write_text("\n".join(lines) + "\n")
    path = hb.open(tmp_path / "s.csv").survey().path()
    fine = np.linspace(0, 2000, 200_001)  # an integral of the tangent in steps of 1 cm
    inc, azi = np.radians(np.interp(fine, depth, inclination)), np.radians(np.interp(fine, depth, azimuth))
    tangent = np.column_stack([np.sin(inc) * np.cos(azi), np.sin(inc) * np.sin(azi), np.cos(inc)])
    truth = np.cumsum(0.5 * (tangent[1:] + tangent[:-1]), axis=0) * 0.01
    assert np.abs(path.position(np.array([1000.0, 2000.0])) - truth[[99_999, -1]]).max() < 0.1
