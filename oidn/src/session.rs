//! Devices and filters, which are given back when they are dropped.

use core::ffi::{CStr, c_int, c_void};
use core::ptr;

use crate::Error;
use crate::symbols::Symbols;

/// The device type of processors, whose memory is that of this program.
const PROCESSOR: c_int = 1;
/// The format of three f32 per pixel.
const FLOAT3: c_int = 3;

/// A device that is ready.
pub struct Device<'a> {
    symbols: &'a Symbols,
    /// Not null.
    handle: *mut c_void,
}

impl<'a> Device<'a> {
    /// The processor, with so many threads; 0 for one per core.
    pub fn new(symbols: &'a Symbols, threads: usize) -> Result<Self, Error> {
        // SAFETY: any device type may be asked for; what is not there gives null.
        let handle = unsafe { (symbols.new_device)(PROCESSOR) };
        if handle.is_null() {
            return Err(Error("it cannot run on this processor".into()));
        }
        let device = Self { symbols, handle };
        let threads = c_int::try_from(threads).unwrap_or(c_int::MAX);
        // SAFETY: the device is there, and not committed yet. The name ends in 0 and is read before the call returns.
        unsafe { (symbols.set_device_int)(handle, c"numThreads".as_ptr(), threads) };
        // SAFETY: the device is there.
        unsafe { (symbols.commit_device)(handle) };
        device.checked()?;
        Ok(device)
    }

    /// A number that the device tells.
    pub fn number(&self, name: &CStr) -> i32 {
        // SAFETY: the device is committed. The name ends in 0 and is read before the call returns.
        unsafe { (self.symbols.get_device_int)(self.handle, name.as_ptr()) }
    }

    /// What has gone wrong, if anything has.
    fn checked(&self) -> Result<(), Error> {
        let mut text = ptr::null();
        // SAFETY: the device is there, and `text` is a place for a pointer.
        let code = unsafe { (self.symbols.get_device_error)(self.handle, &raw mut text) };
        match code {
            0 => Ok(()),
            code if text.is_null() => Err(Error(format!("it failed with code {code}"))),
            _ => {
                // SAFETY: not null, so a text that ends in 0 and stays there until the next call for this device.
                let text = unsafe { CStr::from_ptr(text) };
                Err(Error(text.to_string_lossy().into_owned()))
            }
        }
    }

    /// What a ray tracing filter makes of images of `[width, height]` pixels, the first of which is the one to filter,
    /// with these `choices`.
    pub fn filter(
        &self,
        size: [usize; 2],
        inputs: &[(&CStr, &[[f32; 3]])],
        choices: &[&CStr],
    ) -> Result<Vec<[f32; 3]>, Error> {
        let mut output = vec![[0.0; 3]; size[0] * size[1]];
        let filter = Filter::new(self)?;
        for (name, pixels) in inputs {
            assert_eq!(pixels.len(), output.len(), "an image of another size");
            // SAFETY: the pixels are as many as the size says, outlive the filter, and are only read: the library
            // writes to `output` alone, though its interface has no pointers to constants.
            unsafe { filter.set_image(name, pixels.as_ptr().cast_mut().cast(), size) };
        }
        // SAFETY: the pixels are as many as the size says, outlive the filter, and nothing else reads or writes them
        // until it has been executed.
        unsafe { filter.set_image(c"output", output.as_mut_ptr().cast(), size) };
        choices.iter().for_each(|choice| filter.choose(choice));
        filter.execute();
        drop(filter);
        self.checked()?;
        Ok(output)
    }
}

impl Drop for Device<'_> {
    fn drop(&mut self) {
        // SAFETY: the device is there, nothing else gives it back, and filters, which borrow it, are gone.
        unsafe { (self.symbols.release_device)(self.handle) };
    }
}

/// A ray tracing filter.
struct Filter<'a> {
    device: &'a Device<'a>,
    /// Not null.
    handle: *mut c_void,
}

impl<'a> Filter<'a> {
    fn new(device: &'a Device<'a>) -> Result<Self, Error> {
        // SAFETY: the device is committed. The name ends in 0 and is read before the call returns.
        let handle = unsafe { (device.symbols.new_filter)(device.handle, c"RT".as_ptr()) };
        if handle.is_null() {
            device.checked()?;
            return Err(Error("it has no filter for ray tracing".into()));
        }
        Ok(Self { device, handle })
    }

    /// Names an image of `[width, height]` pixels.
    ///
    /// # Safety
    /// So many pixels of three f32 have to be there as long as the filter is, to read, and to write if it is the
    /// output, of which there is one reference at most.
    unsafe fn set_image(&self, name: &CStr, pixels: *mut c_void, [width, height]: [usize; 2]) {
        let set_image = self.device.symbols.set_image;
        // SAFETY: the filter is there, and the pixels are what the caller says. The name ends in 0 and is read before
        // the call returns. Rows follow each other without gaps: strides 0.
        unsafe { set_image(self.handle, name.as_ptr(), pixels, FLOAT3, width, height, 0, 0, 0) };
    }

    /// Says yes to a choice.
    fn choose(&self, name: &CStr) {
        // SAFETY: the filter is there. The name ends in 0 and is read before the call returns.
        unsafe { (self.device.symbols.set_filter_bool)(self.handle, name.as_ptr(), true) };
    }

    /// Runs it, unless something has gone wrong before: then the library does nothing.
    fn execute(&self) {
        // SAFETY: the filter is there.
        unsafe { (self.device.symbols.commit_filter)(self.handle) };
        // SAFETY: the filter is there; its images are, as `set_image` asks for.
        unsafe { (self.device.symbols.execute_filter)(self.handle) };
    }
}

impl Drop for Filter<'_> {
    fn drop(&mut self) {
        // SAFETY: the filter is there, nothing else gives it back, and it is not running: executing returns once done.
        unsafe { (self.device.symbols.release_filter)(self.handle) };
    }
}
