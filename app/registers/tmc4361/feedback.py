"""Encoder, PID and closed loop of the TMC4361."""

from __future__ import annotations

from ..build import RW, R, Rows, W, choice, flag
from ..model import Field
from .rows import CLOCKS, HEADERS, LOW_HIGH, MICROSTEPS, STEPPYR, TOM, TOM_STEPPYR, TOM_TBONE

_encoder = Rows("encoder", HEADERS)
_serial_encoder = Rows("serial encoder", HEADERS)
_closed_loop = Rows("closed loop", HEADERS)
_pid = Rows("pid", HEADERS)

CLOSED_LOOP = "regulation_modus = 1 (closed loop)"
SERIAL = "serial encoder"
ABN = "incremental encoder"

_ENC_IN_CONF = _encoder(0x07, "ENC_IN_CONF", 32, RW, "what the encoder's signals do, and which regulation runs").having(
    choice(0, "enc_sel_decimal", 1, "fraction of ENC_CONST", {0: "binary, /65536", 1: "decimal, /10000"}),
    flag(1, "clear_on_n", "an N event without further conditions sets ENC_POS"),
    flag(2, "clr_latch_cont_on_n", "every N event loads ENC_POS with ENC_RESET_VAL"),
    flag(3, "clr_latch_once_on_n", "the next N event loads ENC_POS with ENC_RESET_VAL"),
    choice(4, "pol_n", 1, "level of an active N", LOW_HIGH),
    choice(
        5,
        "n_chan_sensitivity",
        2,
        "what makes an N event",
        {0: "active level", 1: "edge to active", 2: "edge to inactive", 3: "both edges"},
    ),
    choice(7, "pol_a_for_n", 1, "level of A that an N event needs", {0: "low", 1: "high"}),
    choice(8, "pol_b_for_n", 1, "level of B that an N event needs", {0: "low", 1: "high"}),
    flag(9, "ignore_ab", "N events need no level of A and B"),
    flag(10, "latch_enc_on_n", "an N event latches ENC_POS in ENC_LATCH"),
    flag(11, "latch_x_on_n", "an N event latches XACTUAL in X_LATCH"),
    flag(12, "multi_turn_in_en", "the encoder counts turns"),
    flag(13, "multi_turn_in_signed", "its turns are signed"),
    flag(14, "multi_turn_out_en", "the serial output counts turns"),
    choice(
        15,
        "use_usteps_instead_of_xrange",
        1,
        "what a turn is with circular motion",
        {0: "X_RANGE", 1: "microsteps a revolution"},
    ),
    flag(16, "calc_multi_turn_behav", "turns are counted from single-turn data"),
    flag(17, "ssi_multi_cycle_data", "SSI data are asked for twice and compared"),
    flag(18, "ssi_gray_code_en", "SSI data are Gray coded"),
    flag(19, "left_aligned_data", "status bits come last"),
    flag(20, "spi_data_on_cs", "SPI encoder gives its first bit with chip select"),
    flag(21, "spi_low_before_cs", "SPI encoder's clock goes low before chip select"),
    choice(
        22,
        "regulation_modus",
        2,
        "which regulation runs",
        {0: "none", 1: "closed loop", 2: "PID alone", 3: "PID added to VACTUAL"},
    ),
    flag(24, "cl_calibration_en", "measures CL_OFFSET at standstill"),
    flag(25, "cl_emf_en", "adds up to CL_GAMMA with the speed"),
    flag(26, "cl_clr_xact", "a deviation beyond ENC_POS_DEV_TOL sets XACTUAL to ENC_POS"),
    flag(27, "cl_vlimit_en", "a PI regulator limits the speed of catching up"),
    flag(28, "cl_velocity_mode_en", "XACTUAL never runs more than 768 microsteps ahead"),
    flag(29, "invert_enc_dir", "the encoder counts the other way"),
    flag(30, "enc_out_gray", "the serial output is Gray coded"),
    flag(31, "no_enc_vel_preproc", "V_ENC is not smoothed before its filter", when=ABN),
    flag(31, "serial_enc_variation_limit", "SER_ENC_VARIATION limits jumps", when=SERIAL),
    reset=0x400,
    volatile=True,
    write_note="clr_latch_once_on_n returns to 0 by itself",
    source=f"{TOM_TBONE}; OLDC (reset; another copy has 0x00010400)",
)

_ENCODER_ROWS = (
    _serial_encoder(0x08, "ENC_IN_DATA", 32, RW, "data of a serial encoder", source=TOM).having(
        Field("single_turn_res", 5, "bits of the angle, minus 1", unit="bits - 1", lsb=0),
        Field("multi_turn_res", 5, "bits of the turns, minus 1", unit="bits - 1", lsb=5),
        Field("status_bit_cnt", 2, "status bits", unit="bits", lsb=10),
        Field("serial_addr_bits", 8, "bits of an SPI encoder's address", unit="bits", lsb=16),
        Field("serial_data_bits", 8, "bits of an SPI encoder's data", unit="bits", lsb=24),
    ),
    _serial_encoder(0x09, "ENC_OUT_DATA", 10, RW, "data of the serial encoder output").having(
        Field("single_turn_res_out", 5, "bits of the angle, minus 1", unit="bits - 1", lsb=0),
        Field("multi_turn_res_out", 5, "bits of the turns, minus 1", unit="bits - 1", lsb=5),
        source=TOM,
    ),
    _encoder(0x50, "ENC_POS", 32, RW, "position by the encoder").having(
        signed=True, unit=MICROSTEPS, volatile=True, source=TOM_TBONE
    ),
    _encoder(0x51, "ENC_LATCH", 32, R, "ENC_POS at the latest N event that was to be latched").having(
        signed=True, unit=MICROSTEPS, volatile=True
    ),
    _encoder(0x51, "ENC_RESET_VAL", 32, W, "what an N event loads into ENC_POS", signed=True, unit=MICROSTEPS),
    _encoder(0x52, "ENC_POS_DEV", 32, R, "deviation of the encoder, ENC_POS - XACTUAL").having(
        signed=True, unit=MICROSTEPS, volatile=True, source=f"{HEADERS} (no source tells the sign: our reading)"
    ),
    _closed_loop(
        0x52, "CL_TR_TOLERANCE", 31, W, "deviation up to which a regulated target counts as reached", unit=MICROSTEPS
    ),
    _encoder(0x53, "ENC_POS_DEV_TOL", 31, W, "deviation beyond which ENC_FAIL is raised").having(
        unit=MICROSTEPS, reset=0x7FFFFFFF, source=f"{HEADERS}; OLDC (reset, all ones)"
    ),
    _encoder(0x54, "ENC_IN_RES", 32, W, "resolution of the encoder, from which the chip finds ENC_CONST").having(
        Field("ENC_IN_RES", 31, "counts a motor revolution: 4 a line, or serial counts", unit="counts/rev", lsb=0),
        choice(31, "MANUAL_ENC_CONST", 1, "what the value is", {0: "counts a revolution", 1: "ENC_CONST itself"}),
        source=TOM_TBONE,
    ),
    _encoder(
        0x54,
        "ENC_CONST",
        31,
        R,
        "microsteps that each count of the encoder is worth; enc_sel_decimal tells the fraction",
    ).having(unit="15.16 bits", reset=None, volatile=True),
    _serial_encoder(0x55, "ENC_OUT_RES", 31, W, "resolution of the serial encoder output").having(unit="counts/rev"),
    _serial_encoder(0x56, "SER_CLK_IN_HIGH_LOW", 32, W, "clock for a serial encoder").having(
        Field("SER_CLK_IN_HIGH", 16, "high time", unit=CLOCKS, lsb=0),
        Field("SER_CLK_IN_LOW", 16, "low time", unit=CLOCKS, lsb=16),
        unit=CLOCKS,
        reset=0xA000A0,
        source=f"{HEADERS}; OLDC (reset)",
    ),
    _serial_encoder(
        0x57, "SSI_IN_CLK_DELAY___SSI_IN_WTIME", 32, W, "delay of SSI data, and wait before they are repeated"
    ).having(
        Field("SSI_IN_CLK_DELAY", 16, "data are sampled so much later", unit=CLOCKS, lsb=0),
        Field("SSI_IN_WTIME", 16, "wait between the two readings of one value", unit=CLOCKS, lsb=16),
        unit=CLOCKS,
        reset=0xF00000,
        source=f"{HEADERS}; OLDC (reset)",
    ),
    _serial_encoder(0x58, "SER_PTIME", 20, W, "time between two requests to a serial encoder").having(
        unit=CLOCKS, reset=0x190, source=f"{HEADERS}; OLDC (reset)"
    ),
    _encoder(0x62, "ENC_VEL_ZERO", 24, W, "time without a count after which V_ENC_MEAN is 0").having(
        unit=CLOCKS, reset=0xFFFFFF, source=f"{HEADERS} (unit inferred); OLDC (reset)"
    ),
    _encoder(0x63, "ENC_VMEAN", 32, W, "filter of the encoder's velocity").having(
        Field("ENC_VMEAN_WAIT", 8, "time between two filter steps; more than 32", unit=CLOCKS, lsb=0),
        Field("ENC_VMEAN_FILTER", 4, "exponent of the filter", lsb=8),
        Field("ENC_VMEAN_INT", 16, "time between two values of V_ENC; at least 256", unit=CLOCKS, lsb=16),
    ),
    _serial_encoder(
        0x63,
        "SER_ENC_VARIATION___CL_CYCLE",
        32,
        W,
        "greatest jump of a serial encoder, and time between two regulations",
    ).having(
        Field("SER_ENC_VARIATION", 8, "greatest jump", unit="ENC_IN_RES/2048", lsb=0),
        Field("CL_CYCLE", 16, "time between two regulations", unit=CLOCKS, lsb=16),
        when=SERIAL,
    ),
    _encoder(0x65, "V_ENC", 32, R, "velocity by the encoder", signed=True, unit="pps", volatile=True),
    _encoder(0x66, "V_ENC_MEAN", 32, R, "velocity by the encoder, filtered", signed=True, unit="pps", volatile=True),
    *(
        _serial_encoder(address, name, 32, access, f"{what} an SPI encoder's configuration", volatile=access is R)
        for name, address, access, what in (
            ("ADDR_TO_ENC", 0x68, W, "address for"),
            ("DATA_TO_ENC", 0x69, W, "data for"),
            ("ADDR_FROM_ENC", 0x6A, R, "address of the answer from"),
            ("DATA_FROM_ENC", 0x6B, R, "data of the answer from"),
        )
    ),
    _encoder(
        0x7D, "ENC_COMP", 32, W, "triangle over a revolution that is added to ENC_POS against an eccentric encoder"
    ).having(
        Field("ENC_COMP_XOFFSET", 16, "where the triangle is lowest", unit="rev/65536", lsb=0),
        Field("ENC_COMP_YOFFSET", 8, "its lowest value", signed=True, unit=MICROSTEPS, lsb=16),
        Field("ENC_COMP_AMPL", 8, "its height", unit=MICROSTEPS, lsb=24),
        source=f"{HEADERS}; KMARX (bits of ENC_COMP_AMPL)",
    ),
)

_REGULATION_ROWS = (
    _closed_loop(0x1C, "CL_ANGLES", 24, RW, "commutation angles of closed loop").having(
        Field("CL_BETA", 9, "greatest commutation angle; 255 is a quarter turn", unit="electrical turn/1024", lsb=0),
        Field("CL_GAMMA", 8, "greatest angle against back-EMF", unit="electrical turn/1024", lsb=16),
        reset=0xFF00FF,
        source=TOM_STEPPYR,
    ),
    _closed_loop(
        0x59, "CL_OFFSET", 32, RW, "from ENC_POS to the rotor's electrical angle; calibration finds it"
    ).having(signed=True, unit=MICROSTEPS, volatile=True),
    _pid(0x5A, "PID_VEL", 32, R, "velocity that the PID regulator asks for").having(
        signed=True, unit="pps", volatile=True, source=f"{HEADERS} (unit inferred)"
    ),
    _pid(0x5A, "PID_P", 24, W, "proportional gain", unit="1/256 1/s"),
    _closed_loop(
        0x5A, "CL_VMAX_CALC_P", 24, W, "proportional gain of the speed limit", unit="1/256 1/s", when=CLOSED_LOOP
    ),
    _pid(0x5B, "PID_ISUM_RD", 32, R, "sum of deviations in the PID regulator", signed=True, volatile=True),
    _pid(0x5B, "PID_I", 24, W, "integral gain", unit="1/256"),
    _closed_loop(0x5B, "CL_VMAX_CALC_I", 24, W, "integral gain of the speed limit", unit="1/256", when=CLOSED_LOOP),
    _pid(0x5C, "PID_D", 24, W, "derivative gain"),
    _closed_loop(
        0x5C, "CL_DELTA_P", 24, W, "gain from deviation to commutation angle, outside CL_TOLERANCE; 65536 is 1"
    ).having(unit="1/65536", when=CLOSED_LOOP),
    _pid(0x5D, "PID_E", 32, R, "deviation in the PID regulator, XACTUAL - ENC_POS").having(
        signed=True, unit=MICROSTEPS, volatile=True
    ),
    _pid(0x5D, "PID_I_CLIP___PID_D_CLKDIV", 24, W, "limit of the sum, and how often the derivative is taken").having(
        Field("PID_I_CLIP", 15, "greatest sum of deviations", unit="2^16", lsb=0),
        Field("PID_D_CLKDIV", 8, "regulations to each derivative", unit="128 tCLK", lsb=16),
    ),
    _pid(0x5E, "PID_DV_CLIP", 31, W, "greatest velocity that regulation asks for").having(
        unit="pps", source=f"{HEADERS} (unit inferred)"
    ),
    _pid(0x5F, "PID_TOLERANCE", 20, W, "deviation that the PID regulator takes for 0", unit=MICROSTEPS),
    _closed_loop(0x5F, "CL_TOLERANCE", 8, W, "deviation inside which the gain of closed loop is 1").having(
        unit=MICROSTEPS, when=CLOSED_LOOP, source=f"{HEADERS} (which side of it has gain 1 is our reading)"
    ),
    _closed_loop(0x60, "CL_VMIN_EMF", 24, W, "speed from which the angle against back-EMF grows").having(
        unit="pps", when=CLOSED_LOOP, source=f"{STEPPYR} (unit inferred)"
    ),
    _closed_loop(0x61, "CL_VADD_EMF", 24, W, "so much above CL_VMIN_EMF the angle is CL_GAMMA").having(
        unit="pps", when=CLOSED_LOOP, source=f"{HEADERS} (unit inferred)"
    ),
)

FEEDBACK_ROWS = (_ENC_IN_CONF, *_ENCODER_ROWS, *_REGULATION_ROWS)
