import { useState } from "react";
import { later } from "../../lib/later";
import { useLease } from "./useLease";

const LeaseDialog = later(() => import("./LeaseDialog").then((part) => part.LeaseDialog));

/** The question for the bench, from its first time on. */
export function LeaseQuestion() {
  const { question } = useLease();
  const [asked, setAsked] = useState(false);
  if (question !== null && !asked) setAsked(true);
  return asked && <LeaseDialog />;
}
