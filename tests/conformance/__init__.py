"""Which sections of the data sheets the tests hold: `make conformance`."""
