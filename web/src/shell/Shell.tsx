import { Group, Text } from "@mantine/core";
import { useHotkeys } from "@mantine/hooks";
import { IconHelpCircle, IconSearch } from "@tabler/icons-react";
import { type PropsWithChildren, useEffect, useRef } from "react";
import { Link, useLocation } from "wouter";
import { look } from "../lib/look";
import { useShared } from "../lib/shared";
import { useSelectionInAddress } from "../live/selection";
import { ConditionBar } from "./ConditionBar";
import { ConnectionBanner } from "./ConnectionBanner";
import { CopyLink } from "./CopyLink";
import { DevicePicker } from "./DevicePicker";
import { FirstStart } from "./FirstStart";
import { HeldBack } from "./HeldBack";
import { History } from "./History";
import { LogOut } from "./LogOut";
import { LookButton } from "./LookButton";
import { LeaseControl } from "./lease/LeaseControl";
import { LeaseNews } from "./lease/LeaseNews";
import { LeaseQuestion } from "./lease/LeaseQuestion";
import { PageBoundary } from "./PageBoundary";
import { isAt, PAGES, pagesFor } from "./pages";
import { openPalette, Palette } from "./palette/Palette";
import { RunsUnderWay } from "./RunsUnderWay";
import { ServerStatus } from "./ServerStatus";
import { Shortcuts } from "./Shortcuts";
import { StartUp } from "./StartUp";
import { StopAll } from "./StopAll";
import classes from "./shell.module.css";
import { useAbilities } from "./useAbilities";

/** In a tab of its own: what moves goes on being watched. */
const HELP = "/help/";

/** The frame of every page: pages on the left (on a phone below), the selected axis above, stop always in reach. */
export function Shell({ children }: PropsWithChildren) {
  const [location, go] = useLocation();
  const pages = pagesFor(useAbilities());
  const { clock } = useShared(look);
  useSelectionInAddress();
  // ten keys: the tenth is 0
  useHotkeys(pages.slice(0, 10).map(({ path }, index) => [`alt+${(index + 1) % 10}`, () => go(path)]));
  const bar = useRef<HTMLElement>(null);
  // biome-ignore lint/correctness/useExhaustiveDependencies: another page is another tab, and other pages move it
  useEffect(() => {
    const tab = bar.current?.querySelector("[aria-current='page']");
    tab?.scrollIntoView?.({ block: "nearest", inline: "center" });
  }, [location, pages.length]);
  useEffect(() => {
    const page = PAGES.find((candidate) => isAt(candidate.path, location));
    document.title = page ? `${page.label} · stepscope` : "stepscope";
  }, [location]);

  return (
    <>
      <a className={classes.skip} href="#main">
        Skip to the page
      </a>
      <StartUp />
      <LeaseQuestion />
      <LeaseNews />
      <header className={`${classes.header} row between gap-8`}>
        <Link href="/" className={`ink undecorated row gap-8`} aria-label="stepscope, to the bench">
          <img src="/favicon.svg" width={24} height={24} alt="" />
          <Text fw={700} visibleFrom="sm" component="span">
            stepscope
          </Text>
        </Link>
        <Group gap="md" className={classes.what ?? ""}>
          <DevicePicker />
          <ConditionBar />
          <ServerStatus />
        </Group>
        <Group gap={6} wrap="nowrap" className="rigid">
          <div id="page-tools" className="row gap-6" />
          <LeaseControl />
          <Palette />
          <History />
          <CopyLink />
          <Shortcuts />
          <LookButton />
          <LogOut />
          <StopAll />
        </Group>
      </header>
      <nav className={classes.navbar} aria-label="Pages">
        {pages.map(({ path, label, Icon }) => (
          <Link
            key={path}
            href={path}
            className={`${classes.link} lit row gap-8 text-14`}
            aria-current={isAt(path, location) ? "page" : undefined}
          >
            <Icon size={18} stroke={1.6} aria-hidden />
            {label}
          </Link>
        ))}
        <a href={HELP} target="_blank" rel="noopener" className={`${classes.link} lit row gap-8 text-14`}>
          <IconHelpCircle size={18} stroke={1.6} aria-hidden />
          Help
        </a>
      </nav>
      <main id="main" tabIndex={-1} className={classes.main}>
        <ConnectionBanner />
        <FirstStart />
        <HeldBack />
        <RunsUnderWay />
        <PageBoundary key={`${location} ${clock}`}>{children}</PageBoundary>
      </main>
      <footer className={classes.footer}>
        <nav ref={bar} className={classes.bar} aria-label="Pages">
          {pages.map(({ path, short, label, Icon }) => (
            <Link
              key={path}
              href={path}
              className={`${classes.tab} row hint gap-2`}
              aria-label={label}
              aria-current={isAt(path, location) ? "page" : undefined}
            >
              <Icon size={20} stroke={1.6} aria-hidden />
              {short}
            </Link>
          ))}
          <button type="button" className={`${classes.tab} row hint gap-2`} onClick={openPalette}>
            <IconSearch size={20} stroke={1.6} aria-hidden />
            Find
          </button>
          <a href={HELP} target="_blank" rel="noopener" className={`${classes.tab} row hint gap-2`}>
            <IconHelpCircle size={20} stroke={1.6} aria-hidden />
            Help
          </a>
        </nav>
      </footer>
    </>
  );
}
