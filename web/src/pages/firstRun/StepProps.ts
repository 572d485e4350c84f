import type { Device } from "../../api/queries";
import type { ChosenMotor, Progress } from "./steps";

export interface StepProps {
  device: Device;
  axis: Device["axes"][number];
  disabled: boolean;
  progress: Progress;
  /** done, and on to the next; with a motor where that was chosen */
  onDone: (motor?: ChosenMotor) => void;
}
