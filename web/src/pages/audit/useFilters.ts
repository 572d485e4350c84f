import { putIntoAddress, useAddress, useAddressText } from "../../lib/address";
import { type Filters, SPANS } from "./filters";

/** What of the log is wanted, as the address says. */
export function useFilters(): [Filters, (next: Filters) => void] {
  const { span, ...picked } = useAddress("device", "who", "action", "outcome", "span", "from", "to");
  const [text, setText] = useAddressText("find");
  const filters = { ...picked, text, span: SPANS.find((known) => known === span) ?? "any" };
  const change = ({ text: next, span: chosen, ...others }: Filters) => {
    setText(next);
    putIntoAddress({ ...others, span: chosen === "any" ? "" : chosen }, "replace");
  };
  return [filters, change];
}
