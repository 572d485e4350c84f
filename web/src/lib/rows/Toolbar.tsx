import { Button, CloseButton, Kbd, TextInput } from "@mantine/core";
import { useHotkeys } from "@mantine/hooks";
import { IconPlayerPause, IconPlayerPlay, IconSearch } from "@tabler/icons-react";
import { type PropsWithChildren, useRef, useState } from "react";
import { useAddressText } from "../address";
import css from "./rows.module.css";
import type { Live } from "./useRegisters";

/** What a page of rows looks for, what of it is folded, and whether its values go on. */
export function useRowsView() {
  const [paused, setPaused] = useState(false);
  const [query, setQuery] = useAddressText("find");
  const [folded, setFolded] = useState<Readonly<Record<string, boolean>>>({});
  const fold = (key: string, fold: boolean) => setFolded((now) => ({ ...now, [key]: fold }));
  /** whether a group is folded; `first` until the user has folded or opened it. A search opens all. */
  const isFolded = (key: string, first: boolean) => (query === "" ? (folded[key] ?? first) : false);
  return { paused, setPaused, query, setQuery, fold, isFolded };
}

interface Props {
  /** what is searched, in the plural */
  what: string;
  placeholder: string;
  view: ReturnType<typeof useRowsView>;
  live: Live;
  groups: readonly { rows: readonly unknown[] }[];
}

/** Search, whatever else the page puts there, and how fresh the values are. */
export function Toolbar({ what, placeholder, view, live, groups, children }: PropsWithChildren<Props>) {
  const search = useRef<HTMLInputElement>(null);
  useHotkeys([["/", () => search.current?.focus()]]);
  const { query, setQuery: onQuery, paused, setPaused: onPaused } = view;
  const { connected, ageMs } = live;
  const known = live.readings.data !== undefined;
  const shown = groups.reduce((sum, group) => sum + group.rows.length, 0);
  const state = !connected ? "not connected" : paused ? "paused" : ageMs > 0 ? "no news" : known ? "live" : "reading";
  return (
    <search className={`${css.toolbar} row gap-8`}>
      <TextInput
        ref={search}
        className={css.search}
        aria-label={`Search ${what}`}
        placeholder={placeholder}
        leftSection={<IconSearch size={14} aria-hidden />}
        rightSection={
          query === "" ? (
            <Kbd size="xs" aria-hidden>
              /
            </Kbd>
          ) : (
            <CloseButton size="xs" aria-label="Clear the search" onClick={() => onQuery("")} />
          )
        }
        value={query}
        onChange={(event) => onQuery(event.currentTarget.value)}
        onKeyDown={(event) => {
          if (event.key !== "ArrowDown") return;
          event.preventDefault();
          document.querySelector<HTMLElement>("[data-row]")?.focus();
        }}
      />
      {children}
      <span className="num hint" role="status">
        {query === "" ? "" : `${shown} found`}
      </span>
      <span className="grow" />
      <span className={`${css.liveState} inline hint gap-6`}>
        <span className={`dot ${state === "live" ? "dot-on" : ""}`} aria-hidden />
        <span className="num">{ageMs > 0 && known ? `${state}, ${Math.round(ageMs / 1000)} s old` : state}</span>
      </span>
      <Button
        w={98}
        variant="default"
        disabled={!connected}
        leftSection={paused ? <IconPlayerPlay size={13} aria-hidden /> : <IconPlayerPause size={13} aria-hidden />}
        onClick={() => onPaused(!paused)}
      >
        {paused ? "Resume" : "Pause"}
      </Button>
    </search>
  );
}
