import { lazily } from "../lib/later";
import type { LayoutDocument } from "./document";
import { ofAxis, ofDevice, ofNothing, type PanelType } from "./panel";
import { AxesPanel, DemoPanel, LimitsPanel, MotionPanel, ScopePanel, StagePanel } from "./panels/bench";
import { readNotes } from "./panels/notes";
import { readPlot } from "./panels/plot";
import { readRegisters } from "./panels/registers";

/** Every kind of panel, in the order in which they are offered. */
export const PANELS: readonly PanelType[] = [
  ofNothing({
    type: "motion",
    title: "Motion",
    version: 1,
    min: [280, 200],
    fills: true,
    Panel: MotionPanel,
  }),
  ofNothing({
    type: "axes",
    title: "Devices and axes",
    version: 1,
    min: [220, 120],
    single: true,
    fills: true,
    Panel: AxesPanel,
  }),
  ofNothing({
    type: "scope",
    title: "Scope",
    version: 1,
    min: [480, 320],
    single: true,
    fills: true,
    Panel: ScopePanel,
  }),
  ofAxis({
    type: "xy",
    title: "XY plot",
    version: 1,
    min: [320, 240],
    fills: true,
    config: readPlot,
    Panel: lazily(() => import("./panels/PlotPanel").then((part) => part.XyPanel)),
  }),
  ofAxis({
    type: "residual",
    title: "Residual",
    version: 1,
    min: [320, 200],
    fills: true,
    config: readPlot,
    Panel: lazily(() => import("./panels/PlotPanel").then((part) => part.ResidualPanel)),
  }),
  ofAxis({
    type: "stage",
    title: "Stage",
    version: 1,
    min: [320, 89],
    quiet: true,
    Panel: StagePanel,
  }),
  ofAxis({
    type: "limits",
    title: "Soft limits",
    version: 1,
    min: [280, 26],
    quiet: true,
    Panel: LimitsPanel,
  }),
  ofDevice({
    type: "emulator",
    title: "Emulator",
    version: 1,
    emulated: true,
    quiet: true,
    min: [280, 200],
    single: true,
    Panel: lazily(() => import("./panels/EmulatorPanel").then((part) => part.EmulatorPanel)),
  }),
  ofNothing({
    type: "demo",
    title: "Demo",
    version: 1,
    min: [280, 40],
    single: true,
    quiet: true,
    Panel: DemoPanel,
  }),
  ofAxis({
    type: "twin",
    title: "3D",
    version: 1,
    needs: ["motion"],
    min: [320, 260],
    single: true,
    fills: true,
    keeps: true,
    Panel: lazily(() => import("./panels/TwinPanel").then((part) => part.TwinPanel)),
  }),
  ofAxis({
    type: "polar",
    title: "Encoder over the turn",
    version: 1,
    needs: ["encoder"],
    min: [420, 400],
    Panel: lazily(() => import("./panels/PolarPanel").then((part) => part.PolarPanel)),
  }),
  ofAxis({
    type: "deviation",
    title: "Encoder over time",
    version: 1,
    needs: ["encoder"],
    min: [420, 360],
    fills: true,
    Panel: lazily(() => import("./panels/EncoderTimePanel").then((part) => part.EncoderTimePanel)),
  }),
  ofDevice({
    type: "changes",
    title: "Changes",
    version: 1,
    needs: ["registers"],
    min: [300, 160],
    single: true,
    Panel: lazily(() => import("./panels/ChangesPanel").then((part) => part.ChangesPanel)),
  }),
  ofDevice({
    type: "registers",
    title: "Registers",
    version: 1,
    needs: ["registers"],
    min: [420, 260],
    config: readRegisters,
    Panel: lazily(() => import("./panels/RegistersPanel").then((part) => part.RegistersPanel)),
  }),
  ofDevice({
    type: "log",
    title: "Log of changes",
    version: 1,
    min: [420, 200],
    single: true,
    fills: true,
    Panel: lazily(() => import("./panels/LogPanel").then((part) => part.LogPanel)),
  }),
  ofDevice({
    type: "console",
    title: "Console",
    version: 1,
    min: [420, 260],
    single: true,
    Panel: lazily(() => import("./panels/wire").then((part) => part.ConsolePanel)),
  }),
  ofDevice({
    type: "frames",
    title: "Frames",
    version: 1,
    min: [420, 260],
    single: true,
    Panel: lazily(() => import("./panels/wire").then((part) => part.FramesPanel)),
  }),
  ofDevice({
    type: "macros",
    title: "Macros",
    version: 1,
    needs: ["motion"],
    min: [320, 200],
    single: true,
    Panel: lazily(() => import("./panels/MacrosPanel").then((part) => part.MacrosPanel)),
  }),
  ofDevice({
    type: "recordings",
    title: "Recordings",
    version: 1,
    min: [280, 160],
    single: true,
    Panel: lazily(() => import("./panels/RecordingsPanel").then((part) => part.RecordingsPanel)),
  }),
  ofNothing({
    type: "notes",
    title: "Notes",
    version: 1,
    min: [220, 120],
    config: readNotes,
    Panel: lazily(() => import("./panels/NotesPanel").then((part) => part.NotesPanel)),
  }),
];

const BY_TYPE = new Map(PANELS.map((row) => [row.type, row]));

export function typeOf(type: string | undefined): PanelType | undefined {
  return type === undefined ? undefined : BY_TYPE.get(type);
}

/** What a panel is called: by its type, and by a number where there are several of it. */
export function titleOf({ panels }: LayoutDocument, id: string): string {
  const type = panels[id]?.type ?? "";
  const title = typeOf(type)?.title ?? type;
  const alike = Object.keys(panels).filter((each) => panels[each]?.type === type);
  return alike.length < 2 ? title : `${title} ${alike.indexOf(id) + 1}`;
}
