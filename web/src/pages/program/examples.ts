export interface Example {
  name: string;
  from: string;
  text: string;
}

const MANUAL = "the manual";
const OURS = "stepscope";

/** Programs to begin with: those that the manual shows (FM-PD42-1241), and some that are often wanted. */
export const EXAMPLES: readonly Example[] = [
  {
    name: "First program",
    from: `${MANUAL}, 2.4`,
    text: `    ROL 0, 51200        // rotate left
    WAIT TICKS, 0, 500  // for 5 s
    MST 0
    ROR 0, 51200
    WAIT TICKS, 0, 500
    MST 0

    SAP 4, 0, 51200     // highest velocity
    SAP 5, 0, 51200     // highest acceleration
Loop:
    MVP ABS, 0, 512000
    WAIT POS, 0, 0
    MVP ABS, 0, -512000
    WAIT POS, 0, 0
    JA Loop
`,
  },
  {
    name: "Names for numbers",
    from: `${MANUAL}, 8.3`,
    text: `#include TMCLParam.tmc
MaxSpeed = 50000
MaxAcc = 10000
Position0 = 0
Position1 = 500000
    SAP APMaxPositioningSpeed, Motor0, MaxSpeed
    SAP APMaxAcceleration, Motor0, MaxAcc
MainLoop:
    MVP ABS, Motor0, Position1
    WAIT POS, Motor0, 0
    MVP ABS, Motor0, Position0
    WAIT POS, Motor0, 0
    JA MainLoop
`,
  },
  {
    name: "Three routines to run by address",
    from: `${MANUAL}, 8.6`,
    text: `// Run from 0, 1 or 2.
Func1:
    JA Func1Start
Func2:
    JA Func2Start
Func3:
    JA Func3Start

Func1Start:
    MVP ABS, 0, 1000
    WAIT POS, 0, 0
    MVP ABS, 0, 0
    WAIT POS, 0, 0
    STOP
Func2Start:
    ROL 0, 500
    WAIT TICKS, 0, 100
    MST 0
    STOP
Func3Start:
    ROR 0, 1000
    WAIT TICKS, 0, 700
    MST 0
    STOP
`,
  },
  {
    name: "A timer's interrupt",
    from: `${MANUAL}, 3.5.6.4`,
    text: `#include Interrupts.inc
    VECT TI_TIMER0, Timer0Irq
    SGP TI_TIMER0, 3, 1000  // every second
    EI TI_TIMER0
    EI TI_GLOBAL
Loop:
    SIO 3, 2, 1
    WAIT TICKS, 0, 50
    SIO 3, 2, 0
    WAIT TICKS, 0, 50
    JA Loop

Timer0Irq:
    GIO 0, 2
    JC NZ, Out0Off
    SIO 0, 2, 1
    RETI
Out0Off:
    SIO 0, 2, 0
    RETI
`,
  },
  {
    name: "Search the reference, then go to and fro",
    from: OURS,
    text: `// Goes on only where the search has ended within 30 s.
    RFS START, 0
    WAIT RFS, 0, 3000
    JC ETO, Failed
Loop:
    MVP ABS, 0, 51200
    WAIT POS, 0, 0
    WAIT TICKS, 0, 50
    MVP ABS, 0, 0
    WAIT POS, 0, 0
    WAIT TICKS, 0, 50
    JA Loop
Failed:
    RFS STOP, 0
    MST 0
    STOP
`,
  },
  {
    name: "Ten strokes, counted in a variable",
    from: OURS,
    text: `Count = 7  // a user variable: watch it
    SGP Count, 2, 0
Stroke:
    CSUB There
    CSUB Back
    GGP Count, 2
    CALC ADD, 1
    AGP Count, 2
    COMP 10
    JC LT, Stroke
    STOP

There:
    MVP REL, 0, 5120
    WAIT POS, 0, 0
    RSUB
Back:
    MVP REL, 0, -5120
    WAIT POS, 0, 0
    RSUB
`,
  },
  {
    name: "Speed by the analog input",
    from: OURS,
    text: `#include TMCLParam.tmc
// The input's counts, 0 to 4095, times 20 make pps.
Loop:
    GIO 0, 1
    CALC MUL, 20
    AAP APTargetSpeed, Motor0
    WAIT TICKS, 0, 5
    JA Loop
`,
  },
];
