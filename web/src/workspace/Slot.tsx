import { useContext, useLayoutEffect, useRef } from "react";
import { HostsContext } from "./hosts";
import css from "./workspace.module.css";

/** The place of a panel: it comes here with everything that it holds. */
export function Slot({ id }: { id: string }) {
  const hosts = useContext(HostsContext);
  const place = useRef<HTMLDivElement>(null);
  useLayoutEffect(() => (place.current && hosts ? hosts.lend(id, place.current) : undefined), [id, hosts]);
  return <div ref={place} className={css.slot} />;
}
