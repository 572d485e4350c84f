import { Button, CloseButton, Kbd, TextInput } from "@mantine/core";
import { IconPlayerPause, IconPlayerPlay, IconSearch } from "@tabler/icons-react";
import type { PropsWithChildren, RefObject } from "react";
import css from "./rows.module.css";

interface Props {
  /** what is searched, in the plural */
  what: string;
  placeholder: string;
  searchRef: RefObject<HTMLInputElement>;
  query: string;
  onQuery: (query: string) => void;
  shown: number;
  paused: boolean;
  onPaused: (paused: boolean) => void;
  connected: boolean;
  /** at least one reading has come */
  known: boolean;
  ageMs: number;
}

/** Search, whatever else the page puts there, and how fresh the values are. */
export function Toolbar(props: PropsWithChildren<Props>) {
  const { what, placeholder, searchRef, query, onQuery, shown, children } = props;
  const { paused, onPaused, connected, known, ageMs } = props;
  const state = !connected ? "not connected" : paused ? "paused" : ageMs > 0 ? "no news" : known ? "live" : "reading";
  return (
    <search className={`${css.toolbar} row gap-8`}>
      <TextInput
        ref={searchRef}
        size="xs"
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
      <span className={`${css.shown} num`} role="status">
        {query === "" ? "" : `${shown} found`}
      </span>
      <span className="grow" />
      <span className={`${css.liveState} inline hint gap-6`} data-state={state}>
        <i className={css.dot} aria-hidden />
        <span className="num">{ageMs > 0 && known ? `${state}, ${Math.round(ageMs / 1000)} s old` : state}</span>
      </span>
      <Button
        size="xs"
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
